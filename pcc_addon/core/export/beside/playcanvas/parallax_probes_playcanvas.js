// Loads an export of Parallax Probes for PlayCanvas and makes materials that show its probes.
//
//   const probes = await loadParallaxProbes(pc, app, 'probes/');
//   floor.render.material = mirrorMaterial(pc, probes.get('Hall'), 0.1);
//   app.scene.envAtlas = pc.EnvLighting.generateAtlas(probes.get('Hall').levels);   // PlayCanvas' own lookup

/** The probes of an export by name: {record, levels, shader}. `folder` ends with a slash. */
export async function loadParallaxProbes(pc, app, folder) {
    const { probes } = await (await fetched(`${folder}parallax_probes.json`)).json();
    const loaded = await Promise.all(probes.map(async (record) => {
        const [levels, shader] = await Promise.all([
            cubemap(pc, app, record.name, folder + record.pictures.dds),
            fetched(folder + record.shader).then((answer) => answer.text()),
        ]);
        return [record.name, { record, levels, shader }];
    }));
    return new Map(loaded);
}

/** A material that is nothing but a mirror of a roughness. */
export function mirrorMaterial(pc, probe, roughness = 0) {
    const material = probeMaterial(pc, probe, `
        uniform float pp_rough;
        void main() {
            vec3 incoming = normalize(view_position - place);
            vec4 seen = parallax_probe(pp_levels, place, incoming, normalize(facing), pp_rough);
            color = vec4(seen.rgb * seen.a, 1.0);
        }`);
    material.setParameter('pp_rough', roughness);
    return material;
}

/** A material of a fragment shader's text, which has place, facing, view_position, pp_levels and parallax_probe. */
export function probeMaterial(pc, probe, main) {
    const material = new pc.ShaderMaterial({
        uniqueName: `Probe ${probe.record.shader} ${main.length}`,
        attributes: { vertex_position: pc.SEMANTIC_POSITION, vertex_normal: pc.SEMANTIC_NORMAL },
        vertexGLSL: `
            attribute vec3 vertex_position;
            attribute vec3 vertex_normal;
            uniform mat4 matrix_model;
            uniform mat4 matrix_viewProjection;
            varying vec3 place;
            varying vec3 facing;
            void main() {
                vec4 at = matrix_model * vec4(vertex_position, 1.0);
                place = at.xyz;
                facing = transpose(inverse(mat3(matrix_model))) * vertex_normal;
                gl_Position = matrix_viewProjection * at;
            }`,
        fragmentGLSL: `
            precision highp samplerCube;
            uniform samplerCube pp_levels;
            uniform vec3 view_position;
            varying vec3 place;
            varying vec3 facing;
            ${probe.shader}
            ${main.replaceAll(/\bcolor\b/g, 'gl_FragColor')}`,
    });
    for (const [name, value] of Object.entries(probe.record.numbers)) material.setParameter(name, value);
    material.setParameter('pp_levels', probe.levels);
    material.update();
    return material;
}

function cubemap(pc, app, name, url) {
    return new Promise((resolve, reject) => {
        const asset = new pc.Asset(name, 'texture', { url });
        asset.once('load', () => resolve(asset.resource));
        asset.once('error', (error) => reject(new Error(`${url}: ${error}`)));
        app.assets.add(asset);
        app.assets.load(asset);
    });
}

async function fetched(url) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
    return answer;
}
