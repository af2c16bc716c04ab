// Stage "Render" (5.1, 6): one instance for each face, three vertices each. It reads vertex
// attributes only, so that it also runs without storage buffers (WebGL 2).
// CPU reference: render.rs and shade.rs.

const TAU = 6.283185307;

struct Scene {
    clip_from_world: mat4x4f,
    // xyz: place of the eye (m); w: 1 to shift the texture (eqs. 10, 11), 0 not to.
    eye: vec4f,
    // xyz: unit vector towards the light.
    light: vec4f,
    // xyz: unit vector upwards.
    up: vec4f,
    // Linear colour that the texture is multiplied with.
    colour: vec4f,
    // f, f′, f, f′ of two entries each.
    profile: array<vec4f, 16>,
}

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var base_colour: texture_2d<f32>;
@group(0) @binding(2) var base_sampler: sampler;

// The faces in the layout of gather.wgsl.
struct Face {
    @location(0) position_a: vec4f,
    @location(1) position_b: vec4f,
    @location(2) position_c: vec4f,
    @location(3) normal_a: vec4f,
    @location(4) normal_b: vec4f,
    @location(5) normal_c: vec4f,
    @location(6) wave_a: vec4f,
    @location(7) wave_b: vec4f,
    @location(8) wave_c: vec4f,
    @location(9) v: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) weights: vec3f,
    // Argument of each corner's wave.
    @location(1) arguments: vec3f,
    @location(2) position: vec3f,
    @location(3) normal: vec3f,
    @location(4) uv: vec2f,
    @location(5) @interpolate(flat) amplitudes: vec3f,
    @location(6) @interpolate(flat) wave_a: vec3f,
    @location(7) @interpolate(flat) wave_b: vec3f,
    @location(8) @interpolate(flat) wave_c: vec3f,
    // Gradients of u and v by position, eq. 11.
    @location(9) @interpolate(flat) u_gradient: vec3f,
    @location(10) @interpolate(flat) v_gradient: vec3f,
}

@vertex
fn render_vertex(@builtin(vertex_index) index: u32, face: Face) -> Varying {
    let corner = index % 3u;
    let weights = vec3f(f32(corner == 0u), f32(corner == 1u), f32(corner == 2u));
    let position = face.position_a.xyz * weights.x
        + face.position_b.xyz * weights.y
        + face.position_c.xyz * weights.z;
    let normal = face.normal_a.xyz * weights.x
        + face.normal_b.xyz * weights.y
        + face.normal_c.xyz * weights.z;
    let u = vec3f(face.wave_a.w, face.wave_b.w, face.wave_c.w);
    let side_b = face.position_b.xyz - face.position_a.xyz;
    let side_c = face.position_c.xyz - face.position_a.xyz;
    let twice = cross(side_b, side_c);
    let area = length(twice);
    var out: Varying;
    out.clip = scene.clip_from_world * vec4f(position, 1.0);
    out.weights = weights;
    out.arguments = vec3f(
        dot(face.wave_a.xyz, position - face.position_a.xyz) + face.normal_a.w,
        dot(face.wave_b.xyz, position - face.position_b.xyz) + face.normal_b.w,
        dot(face.wave_c.xyz, position - face.position_c.xyz) + face.normal_c.w,
    );
    out.position = position;
    out.normal = normal;
    out.uv = vec2f(dot(u, weights), dot(face.v.xyz, weights));
    out.amplitudes = vec3f(face.position_a.w, face.position_b.w, face.position_c.w);
    out.wave_a = face.wave_a.xyz;
    out.wave_b = face.wave_b.xyz;
    out.wave_c = face.wave_c.xyz;
    out.u_gradient = vec3f();
    out.v_gradient = vec3f();
    if area > 1e-30 {
        let n = twice / area;
        let along_b = cross(side_c, n) / area;
        let along_c = cross(n, side_b) / area;
        out.u_gradient = (u.y - u.x) * along_b + (u.z - u.x) * along_c;
        out.v_gradient = (face.v.y - face.v.x) * along_b + (face.v.z - face.v.x) * along_c;
    }
    return out;
}

// f and f′, linear between the table's 32 entries.
fn profile_at(phase: f32) -> vec2f {
    let at = phase / TAU * 32.0;
    let low = floor(at);
    let i = u32(low - 32.0 * floor(low / 32.0)) % 32u;
    let j = (i + 1u) % 32u;
    let a = scene.profile[i / 2u];
    let b = scene.profile[j / 2u];
    return mix(select(a.zw, a.xy, i % 2u == 0u), select(b.zw, b.xy, j % 2u == 0u), at - low);
}

fn unit_or(v: vec3f, other: vec3f) -> vec3f {
    let size = length(v);
    return select(other, v / max(size, 1e-20), size > 1e-20);
}

@fragment
fn render_pixel(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let a = profile_at(in.arguments.x);
    let b = profile_at(in.arguments.y);
    let c = profile_at(in.arguments.z);
    let scale = in.weights * in.amplitudes;
    let height_m = scale.x * a.x + scale.y * b.x + scale.z * c.x;
    let gradient = in.wave_a * (scale.x * a.y)
        + in.wave_b * (scale.y * b.y)
        + in.wave_c * (scale.z * c.y);
    let base_normal = unit_or(in.normal, vec3f(0.0, 0.0, 1.0));
    let outer = unit_or(base_normal - gradient, base_normal);
    let normal = select(-outer, outer, front);
    let to_viewer = scene.eye.xyz - in.position;
    // Eq. 10; on the back the height counts the other way, and so does the normal.
    let rise = dot(to_viewer, base_normal);
    let shift = (to_viewer - base_normal * rise)
        * (rise / max(rise * rise + 0.1 * dot(to_viewer, to_viewer), 1e-30) * height_m);
    let uv = in.uv + scene.eye.w * vec2f(dot(in.u_gradient, shift), dot(in.v_gradient, shift));
    let albedo = textureSampleLevel(base_colour, base_sampler, uv, 0.0).rgb * scene.colour.rgb;
    return vec4f(shade(albedo, normal, normalize(to_viewer)), 1.0);
}

// One light, sky and ground, and a faint sheen (linear colours). As in shade.rs.
fn shade(albedo: vec3f, normal: vec3f, to_viewer: vec3f) -> vec3f {
    let sky = 0.5 + 0.5 * dot(normal, scene.up.xyz);
    let ambient = mix(vec3f(0.10, 0.09, 0.08), vec3f(0.28, 0.30, 0.34), sky);
    let lit = max(dot(normal, scene.light.xyz), 0.0);
    let halfway = max(dot(normal, normalize(scene.light.xyz + to_viewer)), 0.0);
    let squared = halfway * halfway;
    let fourth = squared * squared;
    let sheen = 0.06 * lit * fourth * fourth * fourth;
    return albedo * (ambient + vec3f(0.92, 0.90, 0.86) * lit) + vec3f(sheen);
}
