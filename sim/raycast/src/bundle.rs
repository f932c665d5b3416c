//! Rays and what they hit, one by one and by 64.

/// A half-line. The direction may have any length; ranges are multiples of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes: metres per unit of range.
    pub direction: [f32; 3],
}

/// What a ray met first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the ray, in lengths of its direction: metres for a unit direction.
    pub range: f32,
    /// Number of the triangle.
    pub triangle: u32,
}

/// 64 rays, component by component. Those that go about the same way from about the same place are
/// cast fastest; the first 16, the next 16, ... should be closest to one another.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Bundle {
    /// Origins: `[axis][ray]`.
    pub origin: [[f32; Self::RAYS]; 3],
    /// Directions: `[axis][ray]`.
    pub direction: [[f32; Self::RAYS]; 3],
}

impl Bundle {
    /// Rays in a bundle.
    pub const RAYS: usize = 64;

    /// A bundle of which no ray hits anything, for all of it is NaN.
    #[must_use]
    pub fn empty() -> Self {
        Self { origin: [[f32::NAN; Self::RAYS]; 3], direction: [[f32::NAN; Self::RAYS]; 3] }
    }

    /// The rays in their order; lanes that are left over hit nothing. At most 64 are taken.
    #[must_use]
    pub fn of(rays: &[Ray]) -> Self {
        let mut bundle = Self::empty();
        for (lane, ray) in rays.iter().take(Self::RAYS).enumerate() {
            bundle.put(lane, ray);
        }
        bundle
    }

    /// Lays a ray into a lane.
    ///
    /// # Panics
    /// If there is no such lane.
    pub fn put(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
    }

    /// The ray in a lane.
    ///
    /// # Panics
    /// If there is no such lane.
    #[must_use]
    pub fn ray(&self, lane: usize) -> Ray {
        Ray { origin: self.origin.map(|axis| axis[lane]), direction: self.direction.map(|axis| axis[lane]) }
    }
}

/// What the rays of a bundle met.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Hits {
    /// Ranges; infinite where nothing was met.
    pub range: [f32; Bundle::RAYS],
    /// Numbers of triangles; [`Hits::NOTHING`] where nothing was met.
    pub triangle: [u32; Bundle::RAYS],
}

impl Hits {
    /// In place of a triangle's number: the ray met none.
    pub const NOTHING: u32 = u32::MAX;

    /// Nothing met at all.
    #[must_use]
    pub fn none() -> Self {
        Self { range: [f32::INFINITY; Bundle::RAYS], triangle: [Self::NOTHING; Bundle::RAYS] }
    }

    /// What the ray in a lane met.
    ///
    /// # Panics
    /// If there is no such lane.
    #[must_use]
    pub fn hit(&self, lane: usize) -> Option<Hit> {
        let (range, triangle) = (self.range[lane], self.triangle[lane]);
        (triangle != Self::NOTHING).then_some(Hit { range, triangle })
    }

    /// Says what the ray in a lane met.
    ///
    /// # Panics
    /// If there is no such lane.
    pub fn put(&mut self, lane: usize, hit: Option<Hit>) {
        let hit = hit.unwrap_or(Hit { range: f32::INFINITY, triangle: Self::NOTHING });
        self.range[lane] = hit.range;
        self.triangle[lane] = hit.triangle;
    }
}
