//! Photographs of nails to coloration maps (section 4.2.2, Fig. 51-56).

pub mod outline;
