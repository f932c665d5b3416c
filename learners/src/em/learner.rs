//! How an answer to EM's questions becomes a learner.

/// Declares a learner that is EM with certain answers: its row in the catalogue, and the parameters that all of these
/// learners have, besides those of its own.
macro_rules! em_learner {
    (
        $(#[$meta:meta])* $T:ident, $name:literal, $what:literal,
        source $source:literal, tolerance $tolerance:literal, { $($own:tt)* }
        $place:ident, |$learner:pat_param| $answers:expr
    ) => {
        $crate::learner::learner! {
            $(#[$meta])*
            $T, $name, $what, source $source, needs Both,
            {
                /// Degree of f, a polynomial of the distance.
                degree: u32 = 3, "1", 1.0..=5.0;
                $($own)*
                /// Stops after so many iterations without a new best likelihood.
                patience: u32 = 50, "1", 1.0..=100000.0;
                /// Stops when three iterations in a row change the log-likelihood by less; 0: never for this reason.
                tolerance: f64 = $tolerance, "nat", 0.0..=1000.0;
                /// Stops after so many iterations at the latest.
                max_iterations: u32 = 5000, "1", 1.0..=1000000.0;
            }
        }

        impl $T {
            /// The answers to EM's questions.
            #[must_use]
            pub fn em(&self) -> $crate::em::Em {
                let $learner = self;
                $crate::em::Em {
                    coefficients: self.degree as usize + 1,
                    patience: self.patience,
                    tolerance: self.tolerance,
                    max_iterations: self.max_iterations,
                    ..$answers
                }
            }
        }

        impl $crate::learner::Learner for $T {
            fn learn(
                &self,
                log: &asami_dataset::Log,
                given: &asami_dataset::Models,
                rng: &mut asami_dataset::Rng,
            ) -> Result<$crate::learner::Learned, $crate::learner::CannotLearn> {
                self.em().$place(log, given, rng)
            }
        }
    };
}
pub(crate) use em_learner;
