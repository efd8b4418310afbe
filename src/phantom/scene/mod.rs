//! What phantoms write: recordings, their places, what is wrong with a request.

pub(in crate::phantom) mod faults;
pub(in crate::phantom) mod lens;
pub(in crate::phantom) mod place;
pub(in crate::phantom) mod recording;
pub(in crate::phantom) mod reel;
