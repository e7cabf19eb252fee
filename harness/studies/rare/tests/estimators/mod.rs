//! The estimators against closed forms.

mod coverage;
mod honest;
