//! Least squares and singular values of small problems.

pub(in crate::fit) mod calibrate;
pub(in crate::fit) mod levenberg;
pub(in crate::fit) mod qr;
pub(in crate::fit) mod svd;
