// A job type of Flamenco: copy it into the `scripts` folder of the Manager. The page is docs/farm.md.
const JOB_TYPE = {
    label: "Parallax probes",
    settings: [
        { key: "blendfile", type: "string", required: true, eval: "bpy.data.filepath", visible: "web",
          description: "The .blend, at a place that all Workers share" },
        { key: "shares", type: "int32", default: 4,
          description: "Tasks: as many as there are probes gives a task a probe; more give ranges of faces" },
    ],
};

function compileJob(job) {
    const bake = ["--background", "--command", "pcc", "bake", job.settings.blendfile, "--resume"];
    const assemble = author.Task("assemble", "misc");
    assemble.addCommand(author.Command("exec", { exe: "blender", args: bake.concat(["--inject", "--save"]) }));
    for (let share = 1; share <= job.settings.shares; share++) {
        const task = author.Task("share-" + share, "misc");
        const args = bake.concat(["--share", share + "/" + job.settings.shares]);
        task.addCommand(author.Command("exec", { exe: "blender", args: args }));
        assemble.addDependency(task);
        job.addTask(task);
    }
    job.addTask(assemble);
}
