"""The benchmark's peers: the same two models by other tools, and what measures time, memory and quality."""
