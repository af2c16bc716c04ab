// The mean of each pixel's samples, as sRGB numbers. CPU reference: `Painter::read`.

override side: i32 = 2;

@group(0) @binding(0) var samples: texture_2d<f32>;

@vertex
fn average_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    // One triangle over all pixels.
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn average_pixel(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let first = vec2i(place.xy) * side;
    var sum = vec3f(0.0);
    for (var y = 0; y < side; y++) {
        for (var x = 0; x < side; x++) {
            sum += textureLoad(samples, first + vec2i(x, y), 0).rgb;
        }
    }
    let linear = sum / f32(side * side);
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(1e-9)), vec3f(1.0 / 2.4)) - 0.055;
    return vec4f(select(high, low, linear <= vec3f(0.0031308)), 1.0);
}
