"""The C interface of the library, for ctypes. Made by python/make_bindings.py from include/pointskin/c.h."""
from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int32, c_int64, c_size_t, c_uint8,
                    c_uint64, c_void_p)

psk_progress = CFUNCTYPE(c_int32, c_char_p, c_double, c_void_p)

PSK_OK = 0
PSK_INTERNAL = 1
PSK_USAGE = 2
PSK_INVALID_INPUT = 3
PSK_NO_NORMALS = 4
PSK_EMPTY_RESULT = 5
PSK_OVER_LIMIT = 6
PSK_DEVICE_UNAVAILABLE = 7
PSK_OUTPUT_NOT_WRITTEN = 8
PSK_INTERRUPTED = 130
PSK_STRUCT_OPTIONS = 1
PSK_STRUCT_NORMAL_OPTIONS = 2
PSK_STRUCT_READ_OPTIONS = 3
PSK_STRUCT_WRITE_OPTIONS = 4
PSK_STRUCT_POINTS = 5
PSK_STRUCT_TRIANGLES = 6
PSK_STRUCT_RUN_REPORT = 7
PSK_STRUCT_NORMAL_REPORT = 8
PSK_STRUCT_MESH_REPORT = 9
PSK_STRUCT_COMPARE_OPTIONS = 10
PSK_STRUCT_COMPARISON = 11
PSK_STRUCT_RENDER_OPTIONS = 12
PSK_STRUCT_RENDER_REPORT = 13
PSK_STRUCT_PROBLEM_OPTIONS = 14
PSK_STRUCT_PROBLEM = 15
PSK_STRUCT_EDIT_OPTIONS = 16
PSK_STRUCT_OPERATION = 17
PSK_STRUCT_STEP_REPORT = 18
PSK_STRUCT_HANDLE = 19
PSK_STRUCT_LATTICE = 20
PSK_STRUCT_DEFORM_REPORT = 21
PSK_STRUCT_BOOLEAN_OPTIONS = 22
PSK_STRUCT_BOOLEAN_REPORT = 23
PSK_STRUCT_FLUID_OPTIONS = 24
PSK_STRUCT_FLUID_REPORT = 25
PSK_STRUCT_DEPTH_SUGGESTION = 26
PSK_STRUCT_SCALE_OPTIONS = 27
PSK_STRUCT_COUNT = 27
PSK_INT8 = 0
PSK_UINT8 = 1
PSK_INT16 = 2
PSK_UINT16 = 3
PSK_INT32 = 4
PSK_UINT32 = 5
PSK_INT64 = 6
PSK_UINT64 = 7
PSK_FLOAT32 = 8
PSK_FLOAT64 = 9
PSK_HOST = 0
PSK_DEVICE = 1
PSK_NORMALS_AUTOMATIC = 0
PSK_NORMALS_SENSOR = 1
PSK_NORMALS_PROPAGATE = 2
PSK_NORMALS_ITERATE = 3
PSK_NORMALS_REPAIR = 4
PSK_POINT_NORMALS_AUTOMATIC = 0
PSK_POINT_NORMALS_GIVEN = 1
PSK_POINT_NORMALS_REPAIR = 2
PSK_POINT_NORMALS_ESTIMATE = 3
PSK_FIELD_POISSON = 0
PSK_FIELD_DISTANCE = 1
PSK_BOUNDARY_FREE = 0
PSK_BOUNDARY_DIRICHLET = 1
PSK_FACES_CLOSED = 0
PSK_FACES_OPEN = 1
PSK_UP_Y = 0
PSK_UP_Z = 1
PSK_UP_X = 2
PSK_UP_MINUS_X = 3
PSK_UP_MINUS_Y = 4
PSK_UP_MINUS_Z = 5
PSK_GUIDE = 0
PSK_REMOVE = 1
PSK_INSERT = 2
PSK_FLIP = 3
PSK_HALF_SPACE = 0
PSK_BALL = 1
PSK_AXIS_BOX = 2
PSK_CAPSULE = 3
PSK_POINT_SET = 4
PSK_UNITE = 0
PSK_INTERSECT = 1
PSK_SUBTRACT = 2
PSK_SYMMETRIC_DIFFERENCE = 3
PSK_ISOTROPIC = 0
PSK_ANISOTROPIC = 1


class psk_error(Structure):
    _fields_ = (
        ("code", c_int32),
        ("message", c_char * 1020),
    )


class psk_array(Structure):
    _fields_ = (
        ("data", c_void_p),
        ("rows", c_int64),
        ("row_stride", c_int64),
        ("component_stride", c_int64),
        ("components", c_int32),
        ("type", c_int32),
        ("memory", c_int32),
        ("reserved", c_int32),
    )


class psk_attribute(Structure):
    _fields_ = (
        ("name", c_char_p),
        ("values", psk_array),
        ("missing", POINTER(c_uint8)),
    )


class psk_points(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("positions", psk_array),
        ("normals", psk_array),
        ("attributes", POINTER(psk_attribute)),
        ("attribute_count", c_int64),
        ("origin", c_double * 3),
    )


class psk_triangles(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("vertices", POINTER(psk_points)),
        ("triangles", psk_array),
    )


class psk_read_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("shift", POINTER(c_double)),
        ("threads", c_int32),
    )


class psk_write_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("ascii", c_int32),
        ("threads", c_int32),
        ("double_coordinates", c_int32),
        ("compress", c_int32),
    )


class psk_normal_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("sensors", POINTER(c_double)),
        ("sensor_count", c_int64),
        ("progress", psk_progress),
        ("user", c_void_p),
        ("seed", c_uint64),
        ("time_limit_s", c_double),
        ("keep_within_degrees", c_double),
        ("method", c_int32),
        ("random_start", c_int32),
        ("max_rounds", c_int32),
        ("confidence", c_int32),
        ("curvature", c_int32),
    )


class psk_normal_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("assumed", c_char_p),
        ("warning", c_char_p),
        ("points", c_int64),
        ("given", c_int64),
        ("kept", c_int64),
        ("flipped", c_int64),
        ("replaced", c_int64),
        ("doubtful", c_int64),
        ("patches", c_int64),
        ("components", c_int64),
        ("turned", c_int64),
        ("device_peak_bytes", c_int64),
        ("enclosing", c_double),
        ("estimate_ms", c_double),
        ("propagate_ms", c_double),
        ("iterate_ms", c_double),
        ("total_ms", c_double),
        ("method", c_int32),
        ("rounds", c_int32),
        ("settled", c_int32),
    )


class psk_mesh_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("vertices", c_int64),
        ("used_vertices", c_int64),
        ("triangles", c_int64),
        ("edges", c_int64),
        ("boundary_edges", c_int64),
        ("non_manifold_edges", c_int64),
        ("misoriented_edges", c_int64),
        ("non_manifold_vertices", c_int64),
        ("degenerate_triangles", c_int64),
        ("components", c_int64),
        ("euler", c_int64),
        ("volume", c_double),
        ("area", c_double),
        ("closed", c_int32),
        ("manifold", c_int32),
        ("oriented", c_int32),
        ("watertight", c_int32),
    )


class psk_scale_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("max_memory_bytes", c_int64),
        ("threads", c_int32),
    )


class psk_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("normal_estimation", POINTER(psk_normal_options)),
        ("envelope", c_void_p),
        ("screening", c_double),
        ("scale", c_double),
        ("samples_per_node", c_double),
        ("offset", c_double),
        ("depth", c_int32),
        ("point_normals", c_int32),
        ("field", c_int32),
        ("fixed_screening", c_int32),
        ("iterations", c_int32),
        ("confidence", c_int32),
        ("boundary", c_int32),
        ("keep_strays", c_int32),
        ("isovalue", c_double),
        ("trim", c_double),
        ("island_ratio", c_double),
        ("min_component", c_double),
        ("has_isovalue", c_int32),
        ("normals", c_int32),
        ("linear_fit", c_int32),
        ("domain_faces", c_int32),
        ("largest", c_int32),
        ("density", c_int32),
        ("weakness", c_int32),
        ("attributes", c_int32),
        ("progress", psk_progress),
        ("user", c_void_p),
        ("max_memory_bytes", c_int64),
        ("residuals", c_int32),
    )


class psk_level_report(Structure):
    _fields_ = (
        ("nodes", c_int64),
        ("unknowns", c_int64),
        ("residual_before", c_double),
        ("residual_after", c_double),
        ("depth", c_int32),
        ("iterations", c_int32),
    )


class psk_warning(Structure):
    _fields_ = (
        ("kind", c_char_p),
        ("text", c_char_p),
        ("share", c_double),
    )


class psk_run_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("warnings", POINTER(psk_warning)),
        ("levels", POINTER(psk_level_report)),
        ("normals_done", c_char_p),
        ("warning_count", c_int64),
        ("level_count", c_int64),
        ("points", c_int64),
        ("strays", c_int64),
        ("nodes", c_int64),
        ("isovalue", c_double),
        ("upload_ms", c_double),
        ("octree_ms", c_double),
        ("splat_ms", c_double),
        ("solve_ms", c_double),
        ("extract_ms", c_double),
        ("download_ms", c_double),
        ("device_peak_bytes", c_int64),
        ("trim_quantile", c_double),
        ("trim_density", c_double),
        ("trim_area_before", c_double),
        ("trim_area_removed", c_double),
        ("trim_triangles_before", c_int64),
        ("trim_triangles_removed", c_int64),
        ("trim_triangles_split", c_int64),
        ("trim_islands_removed", c_int64),
        ("trim_holes_filled", c_int64),
        ("pieces", c_int64),
        ("pieces_removed", c_int64),
        ("pieces_triangles_removed", c_int64),
        ("envelope_samples_outside", c_int64),
        ("envelope_vertices_moved", c_int64),
        ("envelope_farthest_move", c_double),
        ("offset_cells", c_double),
        ("offset_cube_growth", c_double),
        ("offset_ms", c_double),
        ("depth", c_int32),
    )


class psk_depth_suggestion(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("spacing", c_double),
        ("noise", c_double),
        ("depth", c_int32),
        ("supported", c_int32),
    )


class psk_compare_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("samples", c_int64),
        ("tau", c_double),
        ("threads", c_int32),
    )


class psk_comparison(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("reference_diagonal", c_double),
        ("samples", c_int64),
        ("reference_samples", c_int64),
        ("to_reference", c_double * 4),
        ("from_reference", c_double * 4),
        ("two_sided", c_double * 4),
        ("normal_consistency", c_double),
        ("precision", c_double),
        ("recall", c_double),
        ("f_score", c_double),
        ("has_normals", c_int32),
    )


class psk_render_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("target", POINTER(c_double)),
        ("fit_world", POINTER(c_double)),
        ("range", POINTER(c_double)),
        ("colour_by", c_char_p),
        ("azimuth_degrees", c_double),
        ("elevation_degrees", c_double),
        ("zoom", c_double),
        ("field_of_view_degrees", c_double),
        ("point_size", c_double),
        ("point_size_world", c_double),
        ("width", c_int32),
        ("height", c_int32),
        ("up", c_int32),
        ("orthographic", c_int32),
        ("fit_sphere", c_int32),
        ("smooth", c_int32),
        ("back_faces", c_int32),
        ("colours", c_int32),
        ("shadows", c_int32),
        ("wireframe", c_int32),
        ("colour_map", c_int32),
        ("colour_bar", c_int32),
        ("threads", c_int32),
    )


class psk_render_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("covered", c_double),
        ("behind", c_double),
        ("low", c_double),
        ("high", c_double),
        ("point_size_world", c_double),
        ("strays", c_int64),
        ("has_range", c_int32),
    )


class psk_camera(Structure):
    _fields_ = (
        ("view", c_double * 16),
        ("projection", c_double * 16),
        ("width", c_double),
        ("height", c_double),
    )


class psk_problem_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("threshold", c_double),
        ("least_area", c_double),
        ("up", c_int32),
        ("threads", c_int32),
    )


class psk_problem_view(Structure):
    _fields_ = (
        ("azimuth_degrees", c_double),
        ("elevation_degrees", c_double),
        ("target", c_double * 3),
        ("matrix", c_double * 16),
        ("zoom", c_double),
        ("visible", c_double),
    )


class psk_problem(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("score", c_double),
        ("peak", c_double),
        ("area", c_double),
        ("centroid", c_double * 3),
        ("lower", c_double * 3),
        ("upper", c_double * 3),
        ("mean_normal", c_double * 3),
        ("triangles", c_int64),
        ("views", psk_problem_view * 3),
        ("view_count", c_int32),
    )


class psk_edit_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("reconstruction", POINTER(psk_options)),
        ("undo_bytes", c_int64),
        ("topology", c_int32),
        ("warm_start", c_int32),
        ("continued", c_int32),
        ("keep_attributes", c_int32),
        ("states_kept", c_int32),
    )


class psk_polygon(Structure):
    _fields_ = (
        ("pixels", POINTER(c_double)),
        ("count", c_int64),
    )


class psk_operation(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("camera", psk_camera),
        ("area", POINTER(psk_polygon)),
        ("area_count", c_int64),
        ("stroke", POINTER(c_double)),
        ("stroke_count", c_int64),
        ("part", c_void_p),
        ("interval", c_double),
        ("lower", c_double * 3),
        ("upper", c_double * 3),
        ("scale", c_double),
        ("rotation", c_double * 9),
        ("translation", c_double * 3),
        ("kind", c_int32),
        ("stroke_normals", c_int32),
        ("inside_only", c_int32),
        ("originals", c_int32),
        ("front_layer", c_int32),
        ("snap", c_int32),
    )


class psk_step_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("added", c_int64),
        ("removed", c_int64),
        ("flipped", c_int64),
        ("points", c_int64),
        ("triangles", c_int64),
        ("components_before", c_int64),
        ("genus_before", c_int64),
        ("euler_before", c_int64),
        ("components_after", c_int64),
        ("genus_after", c_int64),
        ("euler_after", c_int64),
        ("edit_ms", c_double),
        ("reconstruct_ms", c_double),
        ("total_ms", c_double),
        ("snapped", c_int32),
        ("warm", c_int32),
    )


class psk_handle(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("points", POINTER(c_int64)),
        ("point_count", c_int64),
        ("a", c_double * 3),
        ("b", c_double * 3),
        ("radius", c_double),
        ("axis", c_double * 3),
        ("axis_point", c_double * 3),
        ("angle", c_double),
        ("translation", c_double * 3),
        ("matrix", c_double * 12),
        ("pivot", c_double * 3),
        ("region", c_int32),
        ("affine", c_int32),
    )


class psk_lattice(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("control", POINTER(c_double)),
        ("origin", c_double * 3),
        ("axes", c_double * 9),
        ("spans", c_int32 * 3),
        ("stay", c_int32),
    )


class psk_deform_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("rest_points", c_int64),
        ("points", c_int64),
        ("inserted", c_int64),
        ("thinned", c_int64),
        ("upload_ms", c_double),
        ("rest_ms", c_double),
        ("sample_ms", c_double),
        ("map_ms", c_double),
        ("mesh_ms", c_double),
    )


class psk_boolean_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("reconstruction", POINTER(psk_options)),
        ("coincidence_cells", c_double),
        ("creases", c_int32),
    )


class psk_boolean_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("points", c_int64 * 2),
        ("strays", c_int64 * 2),
        ("kept", c_int64 * 2),
        ("flipped", c_int64 * 2),
        ("dropped", c_int64 * 2),
        ("coincident", c_int64 * 2),
        ("added", c_int64),
        ("device_peak_bytes", c_int64),
        ("curve_length", c_double),
        ("classify_ms", c_double),
        ("crease_ms", c_double),
        ("gather_ms", c_double),
        ("apart_ms", c_double),
        ("total_ms", c_double),
    )


class psk_fluid_options(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("particle_radius", c_double),
        ("smoothing_length", c_double),
        ("cube_size", c_double),
        ("surface_threshold", c_double),
        ("min_component", c_double),
        ("kernel", c_int32),
        ("smoothing_iterations", c_int32),
        ("smoothing_weights", c_int32),
        ("normals", c_int32),
        ("attributes", c_int32),
    )


class psk_fluid_report(Structure):
    _fields_ = (
        ("size", c_size_t),
        ("particles", c_int64),
        ("coarse_corners", c_int64),
        ("fine_corners", c_int64),
        ("removed_components", c_int64),
        ("device_peak_bytes", c_int64),
        ("upload_ms", c_double),
        ("particles_ms", c_double),
        ("field_ms", c_double),
        ("extract_ms", c_double),
        ("finish_ms", c_double),
        ("download_ms", c_double),
        ("depth", c_int32),
        ("rounds", c_int32),
    )


class psk_format(Structure):
    _fields_ = (
        ("name", c_char_p),
        ("extensions", c_char_p),
        ("reads_clouds", c_int32),
        ("reads_meshes", c_int32),
        ("writes_clouds", c_int32),
        ("writes_meshes", c_int32),
    )


#: Result and arguments of every function.
FUNCTIONS = {
    "psk_version": (c_char_p, ()),
    "psk_c_abi": (c_int32, ()),
    "psk_built_with_cuda": (c_int32, ()),
    "psk_struct_size": (c_size_t, (c_int32,)),
    "psk_init": (c_int32, (c_int32, c_void_p, c_size_t, POINTER(psk_error))),
    "psk_workspace_create": (c_int32, (c_char_p, c_int32, POINTER(c_void_p), POINTER(psk_error))),
    "psk_workspace_create_on_stream": (c_int32, (c_int32, c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_workspace_free": (None, (c_void_p,)),
    "psk_workspace_gpu": (c_int32, (c_void_p,)),
    "psk_workspace_device_name": (c_char_p, (c_void_p,)),
    "psk_workspace_stream": (c_void_p, (c_void_p,)),
    "psk_workspace_available_bytes": (c_int64, (c_void_p,)),
    "psk_workspace_held_bytes": (c_int64, (c_void_p,)),
    "psk_workspace_synchronize": (c_int32, (c_void_p, POINTER(psk_error))),
    "psk_workspace_release_memory": (None, (c_void_p,)),
    "psk_cloud_create": (c_int32, (POINTER(psk_points), POINTER(psk_read_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_cloud_read": (c_int32, (c_char_p, POINTER(psk_read_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_cloud_copy": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_cloud_free": (None, (c_void_p,)),
    "psk_cloud_size": (c_int64, (c_void_p,)),
    "psk_cloud_dropped": (c_int64, (c_void_p,)),
    "psk_cloud_origin": (None, (c_void_p, POINTER(c_double))),
    "psk_cloud_positions": (psk_array, (c_void_p,)),
    "psk_cloud_normals": (psk_array, (c_void_p,)),
    "psk_cloud_attribute_count": (c_int64, (c_void_p,)),
    "psk_cloud_attribute": (psk_attribute, (c_void_p, c_int64)),
    "psk_cloud_merge": (c_int32, (c_void_p, c_void_p, POINTER(psk_error))),
    "psk_cloud_keep": (c_int32, (c_void_p, POINTER(c_uint8), c_int64, POINTER(psk_error))),
    "psk_cloud_write": (c_int32, (c_void_p, c_char_p, POINTER(psk_write_options), POINTER(psk_error))),
    "psk_orient": (c_int32, (c_void_p, c_void_p, POINTER(psk_normal_options), POINTER(psk_normal_report), POINTER(psk_error))),
    "psk_mesh_create": (c_int32, (POINTER(psk_triangles), POINTER(psk_read_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_mesh_read": (c_int32, (c_char_p, POINTER(psk_read_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_read": (c_int32, (c_char_p, POINTER(psk_read_options), POINTER(c_void_p), POINTER(c_void_p), POINTER(psk_error))),
    "psk_mesh_write": (c_int32, (c_void_p, c_char_p, POINTER(psk_write_options), POINTER(psk_error))),
    "psk_mesh_copy": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_mesh_free": (None, (c_void_p,)),
    "psk_mesh_memory": (c_int32, (c_void_p,)),
    "psk_mesh_to_host": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_mesh_vertex_count": (c_int64, (c_void_p,)),
    "psk_mesh_triangle_count": (c_int64, (c_void_p,)),
    "psk_mesh_origin": (None, (c_void_p, POINTER(c_double))),
    "psk_mesh_vertices": (psk_array, (c_void_p,)),
    "psk_mesh_normals": (psk_array, (c_void_p,)),
    "psk_mesh_triangles": (psk_array, (c_void_p,)),
    "psk_mesh_attribute_count": (c_int64, (c_void_p,)),
    "psk_mesh_attribute": (psk_attribute, (c_void_p, c_int64)),
    "psk_mesh_gpu": (c_int32, (c_void_p,)),
    "psk_mesh_stream": (c_void_p, (c_void_p,)),
    "psk_mesh_cloud": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_mesh_add_normals": (c_int32, (c_void_p, POINTER(psk_error))),
    "psk_mesh_measure": (c_int32, (c_void_p, c_int32, POINTER(psk_mesh_report), POINTER(psk_error))),
    "psk_measure_file": (c_int32, (c_char_p, POINTER(psk_scale_options), POINTER(psk_mesh_report), POINTER(psk_error))),
    "psk_mesh_self_intersections": (c_int32, (c_void_p, c_int32, POINTER(c_int64), POINTER(c_int64), POINTER(psk_error))),
    "psk_mesh_components": (c_int32, (c_void_p, c_int32, POINTER(c_int32), POINTER(c_int64), POINTER(psk_error))),
    "psk_reconstructor_create": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_reconstructor_free": (None, (c_void_p,)),
    "psk_reconstruct": (c_int32, (c_void_p, c_void_p, POINTER(psk_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_reconstruct_points": (c_int32, (c_void_p, POINTER(psk_points), POINTER(psk_options), c_int32, POINTER(c_void_p), POINTER(psk_error))),
    "psk_reconstructor_report": (c_int32, (c_void_p, POINTER(psk_run_report), POINTER(psk_error))),
    "psk_estimate_device_bytes": (c_int32, (c_void_p, POINTER(psk_options), c_int32, POINTER(c_int64), POINTER(psk_error))),
    "psk_suggest_depth": (c_int32, (c_void_p, c_void_p, POINTER(psk_options), POINTER(psk_depth_suggestion), POINTER(psk_error))),
    "psk_solve": (c_int32, (c_void_p, c_void_p, POINTER(psk_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_solve_points": (c_int32, (c_void_p, POINTER(psk_points), POINTER(psk_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_field_free": (None, (c_void_p,)),
    "psk_field_isovalue": (c_double, (c_void_p,)),
    "psk_field_cube": (None, (c_void_p, POINTER(c_double), POINTER(c_double))),
    "psk_field_values": (c_int32, (c_void_p, POINTER(psk_array), POINTER(c_float), POINTER(psk_error))),
    "psk_field_extract": (c_int32, (c_void_p, POINTER(psk_options), c_int32, POINTER(c_void_p), POINTER(psk_error))),
    "psk_compare": (c_int32, (c_void_p, c_void_p, c_void_p, c_void_p, POINTER(psk_compare_options), POINTER(psk_comparison), POINTER(psk_error))),
    "psk_distances": (c_int32, (c_void_p, c_void_p, c_void_p, c_void_p, c_int32, c_int32, POINTER(c_double), POINTER(psk_error))),
    "psk_render": (c_int32, (c_void_p, c_void_p, POINTER(psk_render_options), POINTER(c_void_p), POINTER(psk_render_report), POINTER(psk_error))),
    "psk_image_free": (None, (c_void_p,)),
    "psk_image_pixels": (psk_array, (c_void_p, POINTER(c_int32), POINTER(c_int32))),
    "psk_image_write_png": (c_int32, (c_void_p, c_char_p, POINTER(psk_error))),
    "psk_image_png": (c_int32, (c_void_p, POINTER(POINTER(c_uint8)), POINTER(c_int64), POINTER(psk_error))),
    "psk_camera_of": (c_int32, (c_void_p, c_void_p, POINTER(psk_render_options), POINTER(psk_camera), POINTER(psk_error))),
    "psk_find_problems": (c_int32, (c_void_p, POINTER(psk_problem_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_problems_count": (c_int64, (c_void_p,)),
    "psk_problems_get": (c_int32, (c_void_p, c_int64, POINTER(psk_problem), POINTER(psk_error))),
    "psk_problems_render": (c_int32, (c_void_p, c_int64, c_int32, c_void_p, POINTER(psk_render_options), c_char_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_problems_free": (None, (c_void_p,)),
    "psk_edit_create": (c_int32, (c_void_p, c_void_p, POINTER(psk_edit_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_edit_free": (None, (c_void_p,)),
    "psk_edit_apply": (c_int32, (c_void_p, POINTER(psk_operation), POINTER(psk_step_report), POINTER(psk_error))),
    "psk_edit_preview": (c_int32, (c_void_p, POINTER(psk_operation), POINTER(c_void_p), POINTER(c_void_p), POINTER(psk_error))),
    "psk_edit_undo": (c_int32, (c_void_p, POINTER(c_int32), POINTER(psk_error))),
    "psk_edit_redo": (c_int32, (c_void_p, POINTER(c_int32), POINTER(psk_error))),
    "psk_edit_mesh": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_edit_cloud": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_deformer_create": (c_int32, (c_void_p, c_void_p, POINTER(psk_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_deformer_free": (None, (c_void_p,)),
    "psk_deformer_deform": (c_int32, (c_void_p, POINTER(psk_handle), c_int64, POINTER(psk_lattice), c_int64, c_double, POINTER(psk_error))),
    "psk_deformer_mesh": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_deformer_cloud": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_deformer_report": (c_int32, (c_void_p, POINTER(psk_deform_report), POINTER(psk_error))),
    "psk_boolean": (c_int32, (c_void_p, c_void_p, c_void_p, c_void_p, c_void_p, c_int32, POINTER(psk_boolean_options), POINTER(c_void_p), POINTER(c_void_p), POINTER(psk_boolean_report), POINTER(psk_error))),
    "psk_fluid_create": (c_int32, (c_void_p, POINTER(c_void_p), POINTER(psk_error))),
    "psk_fluid_free": (None, (c_void_p,)),
    "psk_fluid_surface": (c_int32, (c_void_p, c_void_p, POINTER(psk_fluid_options), POINTER(c_void_p), POINTER(psk_error))),
    "psk_fluid_surface_points": (c_int32, (c_void_p, POINTER(psk_points), POINTER(psk_fluid_options), c_int32, POINTER(c_void_p), POINTER(psk_error))),
    "psk_fluid_get_report": (c_int32, (c_void_p, POINTER(psk_fluid_report), POINTER(psk_error))),
    "psk_format_count": (c_int64, ()),
    "psk_format_get": (psk_format, (c_int64,)),
}

#: The kind of every struct that knows its size.
KINDS = {
    psk_options: PSK_STRUCT_OPTIONS,
    psk_normal_options: PSK_STRUCT_NORMAL_OPTIONS,
    psk_read_options: PSK_STRUCT_READ_OPTIONS,
    psk_write_options: PSK_STRUCT_WRITE_OPTIONS,
    psk_points: PSK_STRUCT_POINTS,
    psk_triangles: PSK_STRUCT_TRIANGLES,
    psk_run_report: PSK_STRUCT_RUN_REPORT,
    psk_normal_report: PSK_STRUCT_NORMAL_REPORT,
    psk_mesh_report: PSK_STRUCT_MESH_REPORT,
    psk_compare_options: PSK_STRUCT_COMPARE_OPTIONS,
    psk_comparison: PSK_STRUCT_COMPARISON,
    psk_render_options: PSK_STRUCT_RENDER_OPTIONS,
    psk_render_report: PSK_STRUCT_RENDER_REPORT,
    psk_problem_options: PSK_STRUCT_PROBLEM_OPTIONS,
    psk_problem: PSK_STRUCT_PROBLEM,
    psk_edit_options: PSK_STRUCT_EDIT_OPTIONS,
    psk_operation: PSK_STRUCT_OPERATION,
    psk_step_report: PSK_STRUCT_STEP_REPORT,
    psk_handle: PSK_STRUCT_HANDLE,
    psk_lattice: PSK_STRUCT_LATTICE,
    psk_deform_report: PSK_STRUCT_DEFORM_REPORT,
    psk_boolean_options: PSK_STRUCT_BOOLEAN_OPTIONS,
    psk_boolean_report: PSK_STRUCT_BOOLEAN_REPORT,
    psk_fluid_options: PSK_STRUCT_FLUID_OPTIONS,
    psk_fluid_report: PSK_STRUCT_FLUID_REPORT,
    psk_depth_suggestion: PSK_STRUCT_DEPTH_SUGGESTION,
    psk_scale_options: PSK_STRUCT_SCALE_OPTIONS,
}
