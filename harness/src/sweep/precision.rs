//! Whether a precision that runs ask for is slower on this machine than singles.

use agents::{Precision, ProductRates};

use super::Sweep;
use crate::Registry;
use crate::error::HarnessError;

impl Sweep {
    /// A line for every environment whose open runs ask for a precision that slows their gradient steps down
    /// here. The products of a gradient step of each kind are computed a few times to find out.
    ///
    /// # Errors
    /// [`HarnessError::Impossible`] if this machine cannot compute them.
    ///
    /// # Panics
    /// If `registry` lacks an environment of the plan.
    pub fn slow_precisions(&self, registry: &Registry) -> Result<Vec<String>, HarnessError> {
        let mut seen = Vec::new();
        let mut lines = Vec::new();
        for job in self.open() {
            let student = &job.config.student;
            let kind = (&job.run().environment, student);
            if student.precision == Precision::F32 || seen.contains(&kind) {
                continue;
            }
            seen.push(kind);
            let spec = &registry.environment(kind.0).expect("a plan only holds known names").spec;
            let rates = ProductRates::measure(student, spec)
                .map_err(|error| HarnessError::impossible(job.run(), "begin")(error))?;
            if let Some(line) = slower(kind.0, student.precision, rates) {
                lines.push(line);
            }
        }
        lines.dedup();
        Ok(lines)
    }
}

/// The line for one kind of run, if it is one.
fn slower(environment: &str, precision: Precision, rates: ProductRates) -> Option<String> {
    let gain = rates.gain(precision);
    (gain < 1.0).then(|| {
        let name = precision.name();
        format!("{environment}: {name} is slower than f32 here: {gain:.2} times its speed in matrix products")
    })
}

#[cfg(test)]
mod tests {
    use agents::{Precision, ProductRates};

    use super::slower;

    #[test]
    fn only_what_is_slower_is_told() {
        let rates = ProductRates { gflop_per_second: [100.0, 50.0] };
        let line = slower("MazeA", Precision::Bf16, rates);
        let expected = "MazeA: bf16 is slower than f32 here: 0.50 times its speed in matrix products";
        assert_eq!(line.as_deref(), Some(expected));
        assert_eq!(slower("MazeA", Precision::F32, rates), None);
        let rates = ProductRates { gflop_per_second: [100.0, 400.0] };
        assert_eq!(slower("MazeA", Precision::Bf16, rates), None);
    }
}
