//! Pictures and the kernels behind them against what is known by other means: exact roots,
//! certified ones, an oracle.

mod alone;
mod antialias;
mod balls;
mod baselines;
mod cameras;
mod certified;
mod counts;
mod domains;
mod framing;
mod normals;
mod overlap;
mod paints;
mod properties;
mod property_support;
mod reference;
mod settled;
mod several;
mod soundness;
mod stability;
mod stability_proofs;
mod stability_solids;
mod strips;
mod truth;
mod truth_support;
mod words;
mod zoom;
