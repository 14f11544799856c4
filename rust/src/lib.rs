//! Compiled kernels of Vedette: pure functions on slices, each with a thin Python binding.

use pyo3::prelude::*;

pub mod align;
pub mod components;
pub mod coverage;
pub mod distance;
pub mod field;
pub mod frontier;
pub mod lidar;
pub mod misses;
pub mod motion;
pub mod planes;
pub mod render;
pub mod search;
pub mod shadow;
pub mod tracking;
pub mod visibility;

#[pymodule]
fn _kernels(m: &Bound<'_, PyModule>) -> PyResult<()> {
    align::register(m)?;
    components::register(m)?;
    coverage::register(m)?;
    distance::register(m)?;
    field::register(m)?;
    frontier::register(m)?;
    lidar::register(m)?;
    misses::register(m)?;
    motion::register(m)?;
    render::register(m)?;
    search::register(m)?;
    tracking::register(m)?;
    visibility::register(m)?;
    Ok(())
}
