//! The WGSL texts of the stages, without extensions.

/// Stage "Skin": entry point `skin`.
pub const SKIN: &str = include_str!("skin.wgsl");
/// Stage "Crush": entry point `crush`.
pub const CRUSH: &str = include_str!("crush.wgsl");
/// Stage "Relax": entry point `relax`.
pub const RELAX: &str = include_str!("relax.wgsl");
/// Stage "Gather": entry point `gather`.
pub const GATHER: &str = include_str!("gather.wgsl");
/// Stage "Render": entry points `render_vertex` and `render_pixel`.
pub const RENDER: &str = include_str!("render.wgsl");

#[cfg(test)]
mod tests {
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    fn checked(text: &str) -> Result<(naga::Module, naga::valid::ModuleInfo), String> {
        let module = naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text))?;
        // No capability beyond what every WebGPU device has.
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .map_err(|e| format!("{e:?}"))?;
        Ok((module, info))
    }

    #[test]
    fn all_stages_are_valid() {
        for (name, text) in [
            ("skin", super::SKIN),
            ("crush", super::CRUSH),
            ("relax", super::RELAX),
            ("gather", super::GATHER),
            ("render", super::RENDER),
        ] {
            if let Err(e) = checked(text) {
                panic!("{name}: {e}");
            }
            assert!(
                checked(&text.replacen("f32", "f33", 1)).is_err(),
                "{name}: the check can fail"
            );
        }
    }

    #[test]
    fn constants_are_those_of_the_cpu_references() {
        let value = |text: &str, name: &str| -> f32 {
            let line =
                text.lines().find_map(|l| l.strip_prefix(&format!("const {name} = "))).unwrap();
            line.trim_end_matches(';').parse().unwrap()
        };
        assert_eq!(value(super::CRUSH, "LEAST_R"), crate::crush::LEAST_R);
        assert_eq!(value(super::CRUSH, "ROUND_OFF"), crate::crush::ROUND_OFF);
        assert_eq!(value(super::CRUSH, "SINGULAR"), crate::crush::SINGULAR);
        assert_eq!(value(super::RELAX, "VISIBLE"), crate::relax::VISIBLE);
        for text in [super::CRUSH, super::RELAX, super::RENDER] {
            assert_eq!(value(text, "TAU"), std::f32::consts::TAU);
        }
    }

    #[test]
    fn render_runs_where_there_are_no_storage_buffers() {
        use naga::back::glsl::{Options, PipelineOptions, Version, Writer};
        let (module, info) = checked(super::RENDER).unwrap();
        for (stage, entry_point) in [
            (naga::ShaderStage::Vertex, "render_vertex"),
            (naga::ShaderStage::Fragment, "render_pixel"),
        ] {
            let options = Options {
                version: Version::Embedded { version: 300, is_webgl: true },
                ..Options::default()
            };
            let pipeline = PipelineOptions {
                shader_stage: stage,
                entry_point: entry_point.to_owned(),
                multiview: None,
            };
            let mut text = String::new();
            let mut writer = Writer::new(
                &mut text,
                &module,
                &info,
                &options,
                &pipeline,
                naga::proc::BoundsCheckPolicies::default(),
            )
            .unwrap();
            writer.write().unwrap();
            assert!(text.contains("300 es") && !text.contains("buffer "));
        }
    }
}
