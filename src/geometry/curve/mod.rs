//! The curve kernels.
