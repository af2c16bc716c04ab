// Stage "Relax" (5.2, eq. 6): one round of gradient descent on the phases towards agreement with
// their neighbours. CPU reference: relax.rs.

const TAU = 6.283185307;
// As in relax.rs.
const VISIBLE = 0.05;

struct Vertex {
    position: vec4f,
    normal: vec4f,
}

struct Round {
    vertices: u32,
    // ε/(2π²).
    rate: f32,
}

@group(0) @binding(0) var<uniform> round: Round;
@group(0) @binding(1) var<storage, read> posed: array<Vertex>;
@group(0) @binding(2) var<storage, read> wave: array<vec4f>;
@group(0) @binding(3) var<storage, read> starts: array<u32>;
@group(0) @binding(4) var<storage, read> neighbours: array<u32>;
@group(0) @binding(5) var<storage, read> phase: array<f32>;
@group(0) @binding(6) var<storage, read_write> next: array<f32>;

@compute @workgroup_size(64)
fn relax(@builtin(global_invocation_id) id: vec3u) {
    let v = id.x;
    if v >= round.vertices {
        return;
    }
    let own = wave[v];
    let x = posed[v].position.xyz;
    let begin = starts[v];
    let end = starts[v + 1u];
    var pull = 0.0;
    var weights = 0.0;
    for (var i = begin; i < end; i++) {
        let n = neighbours[i];
        let other = wave[n];
        let weight = clamp(4.0 * other.w - 0.2, 0.0, 1.0);
        if weight > 0.0 {
            let half = 0.5 * (posed[n].position.xyz - x);
            let turn = select(1.0, -1.0, dot(other.xyz, own.xyz) < 0.0);
            let here = dot(own.xyz, half) + phase[v];
            let there = turn * (phase[n] - dot(other.xyz, half));
            let waves = (there - here) / TAU;
            pull += weight * (waves - floor(waves + 0.5));
            weights += weight;
        }
    }
    var move_by = 0.0;
    if weights > 0.0 {
        if own.w < VISIBLE {
            move_by = TAU * pull / weights;
        } else {
            move_by = round.rate * TAU * pull / f32(end - begin);
        }
    }
    let moved = phase[v] + move_by;
    next[v] = moved - TAU * floor(moved / TAU + 0.5);
}
