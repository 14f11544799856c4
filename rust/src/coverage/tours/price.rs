//! What the end of a tour costs.  docs/theory.md (V194)

/// `linear t + quadratic t^2 / 2`; a tour that ends after an hour costs no more.
#[derive(Clone, Copy)]
pub struct EndPrice {
    pub linear: f64,    // a second
    pub quadratic: f64, // a second^2
}

impl EndPrice {
    pub const FREE: Self = Self { linear: 0.0, quadratic: 0.0 };

    /// Of a tour that ends then [s].
    pub(super) fn of(self, end: f32) -> f64 {
        let t = f64::from(end).min(3600.0);
        (self.linear + 0.5 * self.quadratic * t) * t
    }
}
