// Stage "Skin" (4.1): rest vertices, morphed and moved by their joints. CPU reference: skin.rs.

struct Vertex {
    // xyz: position (m). w, of rest vertices: wavelength (m).
    position: vec4f,
    // xyz: unit normal, or zero.
    normal: vec4f,
}

struct Shift {
    position: vec3f,
    target_index: u32,
    normal: vec3f,
    unused: f32,
}

struct Counts {
    vertices: u32,
    // Groups of four joints each vertex has: 1 or 2.
    groups: u32,
    unused: vec2u,
}

@group(0) @binding(0) var<uniform> counts: Counts;
@group(0) @binding(1) var<storage, read> rest: array<Vertex>;
// Four palette entries of 16 bits each.
@group(0) @binding(2) var<storage, read> joints: array<vec2u>;
@group(0) @binding(3) var<storage, read> weights: array<vec4f>;
// Rows of the affine maps from rest to posed space.
@group(0) @binding(4) var<storage, read> palette: array<mat3x4f>;
// First shift of each vertex.
@group(0) @binding(5) var<storage, read> shift_starts: array<u32>;
@group(0) @binding(6) var<storage, read> shifts: array<Shift>;
@group(0) @binding(7) var<storage, read> morph_weights: array<f32>;
@group(0) @binding(8) var<storage, read_write> posed: array<Vertex>;

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3u) {
    let v = id.x;
    if v >= counts.vertices {
        return;
    }
    var x = rest[v].position.xyz;
    var n = rest[v].normal.xyz;
    for (var s = shift_starts[v]; s < shift_starts[v + 1u]; s++) {
        let weight = morph_weights[shifts[s].target_index];
        x += shifts[s].position * weight;
        n += shifts[s].normal * weight;
    }
    var m = mat3x4f();
    for (var g = 0u; g < counts.groups; g++) {
        let packed = joints[v * counts.groups + g];
        let entries =
            vec4u(packed.x & 0xffffu, packed.x >> 16u, packed.y & 0xffffu, packed.y >> 16u);
        let share = weights[v * counts.groups + g];
        for (var k = 0u; k < 4u; k++) {
            if share[k] > 0.0 {
                m += palette[entries[k]] * share[k];
            }
        }
    }
    // Columns of the linear part.
    let a = vec3f(m[0].x, m[1].x, m[2].x);
    let b = vec3f(m[0].y, m[1].y, m[2].y);
    let c = vec3f(m[0].z, m[1].z, m[2].z);
    // Cofactors, with the determinant's sign: the direction of the inverse transpose.
    let bc = cross(b, c);
    var turned = bc * n.x + cross(c, a) * n.y + cross(a, b) * n.z;
    if dot(bc, a) < 0.0 {
        turned = -turned;
    }
    let size = length(turned);
    let unit = select(vec3f(), turned / max(size, 1e-30), size > 1e-30);
    posed[v] = Vertex(vec4f(vec4f(x, 1.0) * m, rest[v].position.w), vec4f(unit, 0.0));
}
