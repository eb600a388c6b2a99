//! The tessellate kernels.
