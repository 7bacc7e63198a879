//! Tests of pictures and their kernels against independent results: exact roots, certified roots
//! and an oracle.

mod alone;
mod antialias;
mod balls;
mod baselines;
mod cameras;
mod certified;
mod clicks;
mod coincident;
mod counts;
mod domains;
mod folds;
mod framing;
mod models;
mod normals;
mod overlap;
mod paints;
mod parts;
mod properties;
mod property_support;
mod reference;
mod removable;
mod settled;
mod several;
mod soundness;
mod stability;
mod stability_proofs;
mod stability_solids;
mod stretched;
mod strips;
mod truth;
mod truth_support;
mod windows;
mod words;
mod zoom;
