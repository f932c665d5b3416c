//! Named random streams: one seed per case, split by purpose, so that switching one effect off leaves
//! every other draw alone.

use rand::SeedableRng;

/// The portable generator behind every stream.
pub type Rng = rand_chacha::ChaCha8Rng;

/// The seed of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Seed(pub u64);

impl Seed {
    /// The stream for one purpose, for example `"camera"` or `"effect/command_delay"`.
    #[must_use]
    pub fn stream(self, purpose: &str) -> Rng {
        let mut key = [0u8; 32];
        key[..8].copy_from_slice(&self.0.to_le_bytes());
        key[8..16].copy_from_slice(&fnv1a(purpose.as_bytes()).to_le_bytes());
        Rng::from_seed(key)
    }
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}
