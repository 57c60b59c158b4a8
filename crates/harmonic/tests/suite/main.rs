//! Harmonic balance against exact solutions, perturbation theory and second methods.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod backbones;
mod bifurcations;
mod body_damping;
mod condensed;
mod damped_contacts;
mod errors;
mod friction;
mod friction_stability;
mod gaps;
mod integration;
mod koopman_hill;
mod linear;
mod modal_damping;
mod perturbation;
mod ports;
mod reference;
mod rig;
mod rigs;
mod spectral;
mod stability;
mod stepped;
