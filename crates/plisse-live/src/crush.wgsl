// Stage "Crush" (4.2, 5.1): strength and direction of the compression around each vertex.
// CPU reference: crush.rs.

const TAU = 6.283185307;
// As in crush.rs.
const LEAST_R = 0.25;
const ROUND_OFF = 2e-6;
const SINGULAR = 1e-5;

struct Vertex {
    position: vec4f,
    normal: vec4f,
}

struct Counts {
    vertices: u32,
    // 1 if there are as many biases as vertices, else 0.
    biased: u32,
    unused: vec2u,
}

@group(0) @binding(0) var<uniform> counts: Counts;
@group(0) @binding(1) var<storage, read> rest: array<Vertex>;
@group(0) @binding(2) var<storage, read> posed: array<Vertex>;
@group(0) @binding(3) var<storage, read> starts: array<u32>;
@group(0) @binding(4) var<storage, read> neighbours: array<u32>;
// xyz: painted bias p (rest space).
@group(0) @binding(5) var<storage, read> bias: array<vec4f>;
// xyz: unit direction k (rest space); in: the last frame's (zero: none), out: this frame's.
@group(0) @binding(6) var<storage, read_write> direction: array<vec4f>;
// xyz: wave vector (rad/m, posed), w: strength in [0, 1].
@group(0) @binding(7) var<storage, read_write> wave: array<vec4f>;

struct Frame {
    t: vec3f,
    b: vec3f,
    found: bool,
}

// Frame of the tangent plane with normal n: t along the first neighbour that is not above the
// vertex.
fn rest_frame(v: u32, n: vec3f) -> Frame {
    if dot(n, n) >= 0.25 {
        for (var i = starts[v]; i < starts[v + 1u]; i++) {
            let x = rest[neighbours[i]].position.xyz - rest[v].position.xyz;
            let flat = x - n * dot(x, n);
            if dot(flat, flat) > 1e-4 * dot(x, x) && length(flat) > 1e-30 {
                let t = flat / length(flat);
                return Frame(t, cross(n, t), true);
            }
        }
    }
    return Frame(vec3f(), vec3f(), false);
}

fn posed_frame(v: u32, n: vec3f) -> Frame {
    if dot(n, n) >= 0.25 {
        for (var i = starts[v]; i < starts[v + 1u]; i++) {
            let x = posed[neighbours[i]].position.xyz - posed[v].position.xyz;
            let flat = x - n * dot(x, n);
            if dot(flat, flat) > 1e-4 * dot(x, x) && length(flat) > 1e-30 {
                let t = flat / length(flat);
                return Frame(t, cross(n, t), true);
            }
        }
    }
    return Frame(vec3f(), vec3f(), false);
}

struct Found {
    r: f32,
    k: vec3f,
    k_posed: vec3f,
}

fn crush_vertex(v: u32) -> Found {
    let nothing = Found(1.0, vec3f(), vec3f());
    let here = rest_frame(v, rest[v].normal.xyz);
    let there = posed_frame(v, posed[v].normal.xyz);
    if !(here.found && there.found) {
        return nothing;
    }
    var moved = mat2x2f();
    var gram = mat2x2f();
    for (var i = starts[v]; i < starts[v + 1u]; i++) {
        let n = neighbours[i];
        let x = rest[n].position.xyz - rest[v].position.xyz;
        let x_posed = posed[n].position.xyz - posed[v].position.xyz;
        let at = vec2f(dot(here.t, x), dot(here.b, x));
        let at_posed = vec2f(dot(there.t, x_posed), dot(there.b, x_posed));
        moved += mat2x2f(at_posed * at.x, at_posed * at.y);
        gram += mat2x2f(at * at.x, at * at.y);
    }
    let det = determinant(gram);
    let trace = gram[0].x + gram[1].y;
    if !(trace > 1.1754944e-38 && det > SINGULAR * trace * trace) {
        return nothing;
    }
    let inverse_gram = mat2x2f(gram[1].y, -gram[0].y, -gram[1].x, gram[0].x) * (1.0 / det);
    var q = vec2f();
    if counts.biased == 1u {
        let p = bias[v].xyz;
        q = vec2f(dot(here.t, p), dot(here.b, p));
    }
    let shortened = mat2x2f(1.0 - q.x * q.x, -q.x * q.y, -q.x * q.y, 1.0 - q.y * q.y);
    let m = moved * inverse_gram * shortened;
    // The smaller singular value and its right vector.
    let s = transpose(m) * m;
    let mean = 0.5 * (s[0].x + s[1].y);
    let half = 0.5 * (s[0].x - s[1].y);
    if !(mean > 1e-12 && mean < 1e30) {
        return nothing;
    }
    let off = s[1].x;
    let radius = sqrt(half * half + off * off);
    var axis = vec2f(1.0, 0.0);
    if radius > 1e-12 * mean {
        if half >= 0.0 {
            let c = sqrt(0.5 * (1.0 + half / radius));
            axis = vec2f(c, 0.5 * off / (radius * c));
        } else {
            let c = sqrt(0.5 * (1.0 - half / radius));
            axis = vec2f(0.5 * abs(off) / (radius * c), select(c, -c, off < 0.0));
        }
    }
    let weak = vec2f(-axis.y, axis.x);
    let r = length(m * weak);
    // k′ = u/r with u = m·k, taken across the other direction's image, since r may be tiny.
    let across = m * vec2f(-weak.y, weak.x);
    let size = length(across);
    if size <= 1e-20 {
        return nothing;
    }
    var u = vec2f(across.y, -across.x) / size;
    if dot(u, m * weak) < 0.0 {
        u = -u;
    }
    u /= max(r, LEAST_R);
    return Found(r, here.t * weak.x + here.b * weak.y, there.t * u.x + there.b * u.y);
}

@compute @workgroup_size(64)
fn crush(@builtin(global_invocation_id) id: vec3u) {
    let v = id.x;
    if v >= counts.vertices {
        return;
    }
    let found = crush_vertex(v);
    let turn = select(1.0, -1.0, dot(direction[v].xyz, found.k) < 0.0);
    let squared = 1.0 - found.r * found.r;
    let strength = select(sqrt(max(squared, 0.0)), 0.0, squared < ROUND_OFF);
    direction[v] = vec4f(found.k * turn, 0.0);
    wave[v] = vec4f(found.k_posed * (turn * TAU / rest[v].position.w), strength);
}
