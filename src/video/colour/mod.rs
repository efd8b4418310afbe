//! Colours: matrices, curves of light, transfer functions, pixel formats, conversions.

pub(in crate::video) mod bgr;
pub(in crate::video) mod convert;
pub(in crate::video) mod curve;
pub(in crate::video) mod hdr;
pub(in crate::video) mod matrix;
pub(in crate::video) mod pixel;
pub(in crate::video) mod transfer;
