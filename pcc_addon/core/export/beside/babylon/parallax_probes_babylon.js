// Loads an export of Parallax Probes for Babylon.js and makes materials that show its probes.
//
//   const probes = await loadParallaxProbes(BABYLON, scene, 'probes/');
//   floor.material = mirrorMaterial(BABYLON, scene, probes.get('Hall'), 0.1);
//   pbr.reflectionTexture = probes.get('Hall').levels;      // Babylon's own lookup of the same levels
//
// The scene must be left-handed, as Babylon's are unless they say otherwise.

/** The probes of an export by name: {record, levels, shader}. `folder` ends with a slash. */
export async function loadParallaxProbes(BABYLON, scene, folder) {
    if (scene.useRightHandedSystem) throw new Error('the scene is right-handed: this export is for left-handed ones');
    const { probes } = await (await fetched(`${folder}parallax_probes.json`)).json();
    const loaded = await Promise.all(probes.map(async (record) => {
        const levels = BABYLON.CubeTexture.CreateFromPrefilteredData(folder + record.pictures.dds, scene);
        levels.gammaSpace = false;
        if (record.corrected) boxOf(BABYLON, record, levels);
        const [shader] = await Promise.all([
            fetched(folder + record.shader).then((answer) => answer.text()),
            new Promise((resolve) => BABYLON.Texture.WhenAllReady([levels], resolve)),
        ]);
        return [record.name, { record, levels, shader }];
    }));
    return new Map(loaded);
}

/** A material that is nothing but a mirror of a roughness. */
export function mirrorMaterial(BABYLON, scene, probe, roughness = 0) {
    const material = probeMaterial(BABYLON, scene, probe, `
        uniform float pp_rough;
        void main() {
            vec3 incoming = normalize(pp_eye - place);
            vec4 seen = parallax_probe(pp_levels, place, incoming, normalize(facing), pp_rough);
            color = vec4(seen.rgb * seen.a, 1.0);
        }`, ['pp_rough']);
    material.setFloat('pp_rough', roughness);
    return material;
}

/** A material of a fragment shader's text, which has place, facing, pp_eye, pp_levels and parallax_probe. */
export function probeMaterial(BABYLON, scene, probe, main, uniforms = []) {
    const names = Object.keys(probe.record.numbers);
    const material = new BABYLON.ShaderMaterial(`Probe ${probe.record.name}`, scene, {
        vertexSource: `#version 300 es
            precision highp float;
            in vec3 position;
            in vec3 normal;
            uniform mat4 world;
            uniform mat4 viewProjection;
            out vec3 place;
            out vec3 facing;
            void main() {
                vec4 at = world * vec4(position, 1.0);
                place = at.xyz;
                facing = transpose(inverse(mat3(world))) * normal;
                gl_Position = viewProjection * at;
            }`,
        fragmentSource: `#version 300 es
            precision highp float;
            precision highp samplerCube;
            uniform samplerCube pp_levels;
            uniform vec3 pp_eye;
            in vec3 place;
            in vec3 facing;
            out vec4 color;
            ${probe.shader}
            ${main}`,
    }, {
        attributes: ['position', 'normal'],
        uniforms: ['world', 'viewProjection', 'pp_eye', ...names, ...uniforms],
        samplers: ['pp_levels'],
    });
    for (const name of names) {
        const value = probe.record.numbers[name];
        if (Array.isArray(value)) material.setVector3(name, BABYLON.Vector3.FromArray(value));
        else material.setFloat(name, value);
    }
    material.setTexture('pp_levels', probe.levels);
    material.onBindObservable.add(() => material.getEffect().setVector3('pp_eye', scene.activeCamera.globalPosition));
    return material;
}

// Babylon's own parallax is for boxes along the axes, captured in their middle.
function boxOf(BABYLON, record, levels) {
    const { centre, half_edges: edges } = record.box;
    levels.boundingBoxSize = new BABYLON.Vector3(...[0, 1, 2].map((k) => 2 * Math.max(...edges.map((edge) => Math.abs(edge[k])))));
    levels.boundingBoxPosition = BABYLON.Vector3.FromArray(centre);
}

async function fetched(url) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
    return answer;
}
