// Stage "Gather": the data of each face's corners side by side, so that Render needs vertex
// attributes only. CPU reference: gather.rs.

struct Vertex {
    position: vec4f,
    normal: vec4f,
}

struct Face {
    // Of each corner. xyz: position (m), w: amplitude (m).
    position: array<vec4f, 3>,
    // xyz: normal, w: phase (rad).
    normal: array<vec4f, 3>,
    // xyz: wave vector (rad/m), w: u.
    wave: array<vec4f, 3>,
    // v of the three corners.
    v: vec4f,
}

struct Counts {
    faces: u32,
    // First draw vertex in `posed`.
    first_draw: u32,
    // The first face of this batch.
    first_face: u32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> counts: Counts;
// Three draw vertices a face.
@group(0) @binding(1) var<storage, read> corners: array<u32>;
// Welded vertex of each draw vertex.
@group(0) @binding(2) var<storage, read> vertex_of_draw: array<u32>;
@group(0) @binding(3) var<storage, read> uvs: array<vec2f>;
@group(0) @binding(4) var<storage, read> posed: array<Vertex>;
@group(0) @binding(5) var<storage, read> wave: array<vec4f>;
@group(0) @binding(6) var<storage, read> phase: array<f32>;
@group(0) @binding(7) var<storage, read_write> faces: array<Face>;

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    let f = id.x;
    if f >= counts.faces {
        return;
    }
    for (var c = 0u; c < 3u; c++) {
        let draw = corners[3u * (counts.first_face + f) + c];
        let v = vertex_of_draw[draw];
        // Skin keeps the wavelength beside the position; the largest amplitude is a quarter of it.
        let amplitude_m = 0.25 * posed[v].position.w * wave[v].w;
        faces[f].position[c] = vec4f(posed[v].position.xyz, amplitude_m);
        faces[f].normal[c] = vec4f(posed[counts.first_draw + draw].normal.xyz, phase[v]);
        faces[f].wave[c] = vec4f(wave[v].xyz, uvs[draw].x);
        faces[f].v[c] = uvs[draw].y;
    }
}
