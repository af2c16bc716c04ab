//! Text that tests of scenes share.

/// Title and material of a scene, without a panel.
pub(super) const HEAD: &str =
    "title = \"t\"\nmaterial = { young_pa = 1e7, poisson = 0.3, thickness_m = 1e-4 }\n";
