//! The surface kernels.
