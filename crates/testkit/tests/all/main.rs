//! Every stage of evaluation against what shares no code with it.

mod agreement;
mod branches;
mod conformance;
mod exact;
mod exhaustive;
mod findings;
mod forms;
mod properties;
mod reference;
mod reproduce;
mod rigour;
mod simplify;
mod slopes;
mod soundness;
mod threads;
mod tight;
