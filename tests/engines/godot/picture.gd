# Renders scene.json with an export in a folder beside it, and writes what is seen as 32-bit floats into picture.bin.
extends SceneTree

const WALL := """shader_type spatial;
render_mode unshaded, cull_disabled;
uniform samplerCube levels : hint_default_black, filter_linear_mipmap;
#include "res://export/%s.gdshaderinc"
varying vec3 place;
void vertex() { place = (MODEL_MATRIX * vec4(VERTEX, 1.0)).xyz; }
void fragment() { ALBEDO = textureLod(levels, parallax_probe_sampled(place - pp_Capture_Point), 0.0).rgb; }
"""


func _initialize() -> void:
	var view: Dictionary = JSON.parse_string(FileAccess.get_file_as_string("res://scene.json"))
	var listing: Dictionary = JSON.parse_string(FileAccess.get_file_as_string("res://export/parallax_probes.json"))
	var viewport := SubViewport.new()
	viewport.size = Vector2i(view.size[0], view.size[1])
	viewport.use_hdr_2d = true
	viewport.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	root.add_child(viewport)
	var environment := WorldEnvironment.new()
	environment.environment = Environment.new()
	environment.environment.background_mode = Environment.BG_COLOR
	environment.environment.background_color = Color.BLACK
	viewport.add_child(environment)
	var camera := Camera3D.new()
	viewport.add_child(camera)
	var at := vector(view.camera.position)
	camera.look_at_from_position(at, at + vector(view.camera.forward), vector(view.camera.up))
	camera.fov = view.camera.fov
	camera.near = view.camera.near
	camera.far = view.camera.far
	for quad: Dictionary in view.quads:
		viewport.add_child(mesh_of(quad, listing))
	for frame in 4:
		await process_frame
	await RenderingServer.frame_post_draw
	var image := viewport.get_texture().get_image()
	image.convert(Image.FORMAT_RGBAF)
	image.flip_y()
	var file := FileAccess.open("res://picture.bin", FileAccess.WRITE)
	file.store_buffer(image.get_data())
	file.close()
	quit()


func mesh_of(quad: Dictionary, listing: Dictionary) -> MeshInstance3D:
	var record: Dictionary = listing.probes.filter(func(probe: Dictionary) -> bool: return probe.name == quad.probe)[0]
	var stem: String = record.shader.get_basename()
	var material := ShaderMaterial.new()
	if quad.kind == "wall":
		material.shader = Shader.new()
		material.shader.code = WALL % stem
	else:
		material.shader = load("res://export/%s.gdshader" % stem)
		material.set_shader_parameter("rough", quad.roughness)
	material.set_shader_parameter("levels", load("res://export/" + record.pictures.dds))
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array(quad.corners.map(vector))
	arrays[Mesh.ARRAY_NORMAL] = PackedVector3Array([0, 1, 2, 3].map(func(_k: int) -> Vector3: return vector(quad.normal)))
	arrays[Mesh.ARRAY_INDEX] = PackedInt32Array([2, 1, 0, 3, 2, 0])
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.material_override = material
	return instance


func vector(numbers: Array) -> Vector3:
	return Vector3(numbers[0], numbers[1], numbers[2])
