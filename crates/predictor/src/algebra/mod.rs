//! Numerical ground: exact sums and products, scaling, small triangular systems, Cholesky's factorization, singular
//! values, SIMD.

pub(crate) mod cholesky;
pub(crate) mod exact;
pub(crate) mod scale;
pub(crate) mod simd;
pub(crate) mod small;
pub(crate) mod svd;
