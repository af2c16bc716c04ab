//! The material and the options of the solves that a scene asks for.

use super::schema::{Rule, Scene, SurfaceTable};
use crate::field::{FieldOptions, WrinkleFreeRule};
use crate::material::Material;
use crate::shell::BaseOptions;
use crate::wrinkles::SurfaceOptions;
use crate::{At, Result};

/// The material.
pub(super) fn material(scene: &Scene) -> Result<Material> {
    let m = &scene.material;
    Material::new(m.young_pa, m.poisson, m.thickness_m)
        .map_err(|error| match error.field() {
            Some("young") => error.about("young_pa"),
            Some("thickness") => error.about("thickness_m"),
            _ => error,
        })
        .at("material")
}

/// The options of the base solve.
pub(super) fn base_options(scene: &Scene) -> BaseOptions {
    let mut options = BaseOptions::default();
    if let Some(share) = scene.base.compressive_stiffness {
        options.compressive_stiffness = share;
    }
    if let Some(limit) = scene.base.iteration_limit {
        options.iteration_limit = limit;
    }
    options
}

/// The options of the field's solve.
pub(super) fn field_options(scene: &Scene) -> Result<FieldOptions> {
    let mut options = FieldOptions::default();
    match scene.field.wrinkle_free {
        Some(Rule::Paper) => options.rule = WrinkleFreeRule::Paper,
        Some(Rule::Published) => options.rule = WrinkleFreeRule::Published,
        None => {}
    }
    for (i, name) in scene.field.without.iter().enumerate() {
        options =
            options.without(name).map_err(|error| error.about(format!("field.without[{i}]")))?;
    }
    if let Some(rings) = scene.field.curvature_rings {
        options.curvature_rings = rings;
    }
    if let Some(limit) = scene.field.iteration_limit {
        options.iteration_limit = limit;
    }
    Ok(options)
}

/// The options of the wrinkled surface, for a field solved with `field_options`.
pub(super) fn surface_options(scene: &Scene, field_options: &FieldOptions) -> SurfaceOptions {
    let SurfaceTable { levels, v1, v2 } = scene.surface;
    SurfaceOptions { levels, v1, v2, curvature_rings: field_options.curvature_rings }
}
