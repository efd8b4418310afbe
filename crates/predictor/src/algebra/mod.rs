//! Numerical ground: exact sums and products, scaling, small triangular systems, singular values, SIMD.

pub(crate) mod exact;
pub(crate) mod scale;
pub(crate) mod simd;
pub(crate) mod small;
pub(crate) mod svd;
