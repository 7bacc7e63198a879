//! Every stage of evaluation, checked against references that share no code with it.

mod agreement;
mod branches;
mod builders;
mod conformance;
mod exact;
mod exhaustive;
mod findings;
mod forms;
mod programs;
mod properties;
mod reference;
mod reproduce;
mod shortening;
mod simplify;
mod slopes;
mod soundness;
mod threads;
mod tight;
