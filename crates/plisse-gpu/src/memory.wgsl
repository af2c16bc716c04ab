// A copy, to measure the speed of the adapter's memory.

@group(0) @binding(0) var<storage, read> source: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> copy: array<vec4f>;

@compute @workgroup_size(256)
fn copy_memory(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&copy) {
        copy[id.x] = source[id.x];
    }
}
