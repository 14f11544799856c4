//! Fourier transforms of square planes; spectra are kept transposed, which nobody outside sees.

use std::sync::Arc;

use rustfft::num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

/// Transforms of planes of one size, and what they need on the way.
pub struct Plane {
    pub size: usize,
    forth: Arc<dyn Fft<f32>>,
    back: Arc<dyn Fft<f32>>,
    scratch: Vec<Complex32>,
}

impl Plane {
    pub fn new(size: usize) -> Self {
        let mut planner = FftPlanner::new();
        let (forth, back) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
        let length = forth.get_inplace_scratch_len().max(back.get_inplace_scratch_len());
        Plane { size, forth, back, scratch: vec![Complex32::new(0.0, 0.0); length] }
    }

    /// The spectra of a plane's real and of its imaginary part.
    pub fn both_spectra(&mut self, cells: Vec<Complex32>) -> (Vec<Complex32>, Vec<Complex32>) {
        let spectrum = self.transform(cells, &Arc::clone(&self.forth));
        let size = self.size;
        let minus = |k: usize| (size - k) % size;
        let mut real = Vec::with_capacity(size * size);
        let mut imaginary = Vec::with_capacity(size * size);
        for row in 0..size {
            for col in 0..size {
                let here = spectrum[row * size + col];
                let there = spectrum[minus(row) * size + minus(col)].conj();
                real.push((here + there) * 0.5);
                imaginary.push((here - there) * Complex32::new(0.0, -0.5));
            }
        }
        (real, imaginary)
    }

    /// A plane from its spectrum, times the number of its cells.
    pub fn back(&mut self, spectrum: Vec<Complex32>) -> Vec<Complex32> {
        self.transform(spectrum, &Arc::clone(&self.back))
    }

    /// Transform along rows, transpose, and transform along rows again.
    fn transform(&mut self, mut cells: Vec<Complex32>, fft: &Arc<dyn Fft<f32>>) -> Vec<Complex32> {
        fft.process_with_scratch(&mut cells, &mut self.scratch);
        let mut turned = transposed(&cells, self.size);
        fft.process_with_scratch(&mut turned, &mut self.scratch);
        turned
    }
}

/// By blocks, since a column at a time misses the cache.
fn transposed(cells: &[Complex32], size: usize) -> Vec<Complex32> {
    const BLOCK: usize = 16;
    let mut turned = vec![Complex32::new(0.0, 0.0); size * size];
    for top in (0..size).step_by(BLOCK) {
        for left in (0..size).step_by(BLOCK) {
            for row in top..(top + BLOCK).min(size) {
                for col in left..(left + BLOCK).min(size) {
                    turned[col * size + row] = cells[row * size + col];
                }
            }
        }
    }
    turned
}
