// What pages hand back: a picture of floats, or why there is none.

export const scene = await (await fetch('/view/scene.json')).json();

const said = [];
for (const level of ['error', 'warn']) {
    const plain = console[level];
    console[level] = (...words) => { said.push(words.map(String).join(' ')); plain(...words); };
}

export async function render(work) {
    try {
        const pixels = await work();
        const shader = said.find((words) => /shader|program|WebGL/i.test(words) && /error|fail/i.test(words));
        if (shader) throw new Error(shader);
        await fetch('/picture', { method: 'POST', body: new Float32Array(pixels) });
    } catch (error) {
        await fetch('/failed', { method: 'POST', body: `${error.stack ?? error}\n${said.slice(0, 5).join('\n')}` });
    }
}

export const WALL = `
    void main() {
        color = vec4(textureLod(pp_levels, parallax_probe_sampled(place - pp_Capture_Point), 0.0).rgb, 1.0);
    }`;
