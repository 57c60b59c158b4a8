//! The integrators against exact solutions, second methods, and each other.
#![allow(unreachable_pub, reason = "a test binary has no other crate to show its items to")]
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod support;

mod body_damping;
mod both_engines;
mod contact_damping;
mod contact_forms;
mod damped_engines;
mod damping;
mod energy;
mod exact_bars;
mod excitations;
mod friction;
mod interface_waves;
mod invalid_settings;
mod linear_tail;
mod many_contacts;
mod modal_batch;
mod modal_exact;
mod modal_limits;
mod modal_responses;
mod modal_structures;
mod modal_waves;
mod paper_rig;
mod periodic_start;
mod ports;
mod rest;
mod scaling;
mod second_method;
mod sensitivity;
mod taken_on;
mod variable_steps;
