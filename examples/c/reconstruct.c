/* From a file of points to a watertight mesh, in C99.

       cc reconstruct.c $(pkg-config --cflags --libs pointskin) -o reconstruct
       ./reconstruct scan.ply mesh.ply [DEPTH]

   Shows how options are set, how errors are met, how progress is told, and how arrays are looked at without a copy. */
#include <pointskin/c.h>

#include <stdio.h>
#include <stdlib.h>

/* Everything that was made, so that there is one place to free it. */
typedef struct objects {
  psk_workspace* workspace;
  psk_reconstructor* reconstructor;
  psk_cloud* cloud;
  psk_mesh* mesh;
} objects;

static void free_all(objects* all) {
  psk_mesh_free(all->mesh);
  psk_cloud_free(all->cloud);
  psk_reconstructor_free(all->reconstructor);
  psk_workspace_free(all->workspace);
}

/* Called now and then while it works; returning 0 would cancel the run. */
static int32_t tell(const char* phase, double fraction, void* user) {
  FILE* out = (FILE*)user;
  fprintf(out, "%3.0f %% %s\n", 100 * fraction, phase);
  return 1;
}

static psk_code make_mesh(objects* all, const char* in, int depth, psk_error* error) {
  psk_options options;
  PSK_INIT_AS(PSK_STRUCT_OPTIONS, options);
  options.depth = depth;
  options.attributes = 1; /* colours and all else that the points have */
  options.progress = tell;
  options.user = stderr;

  psk_code code = psk_workspace_create("auto", 0, &all->workspace, error);
  if (code == PSK_OK) code = psk_reconstructor_create(all->workspace, &all->reconstructor, error);
  if (code == PSK_OK) code = psk_cloud_read(in, NULL, &all->cloud, error);
  if (code == PSK_OK) code = psk_reconstruct(all->reconstructor, all->cloud, &options, &all->mesh, error);
  return code;
}

/* The highest vertex, read where the library has it. */
static double highest(const psk_mesh* mesh) {
  const psk_array vertices = psk_mesh_vertices(mesh);
  double origin[3], top = -1e300;
  psk_mesh_origin(mesh, origin);
  for (int64_t i = 0; i < vertices.rows; ++i) {
    const float* vertex = (const float*)((const char*)vertices.data + i * vertices.row_stride);
    if (origin[2] + vertex[2] > top) top = origin[2] + vertex[2];
  }
  return top;
}

int main(int argc, char** argv) {
  objects all = {NULL, NULL, NULL, NULL};
  psk_error error;
  if (argc < 3) {
    fprintf(stderr, "usage: reconstruct IN OUT [DEPTH]\n");
    return PSK_USAGE;
  }
  psk_code code = make_mesh(&all, argv[1], argc > 3 ? atoi(argv[3]) : 8, &error);

  psk_mesh_report report;
  PSK_INIT_AS(PSK_STRUCT_MESH_REPORT, report);
  if (code == PSK_OK) code = psk_mesh_measure(all.mesh, 0, &report, &error);
  if (code == PSK_OK) code = psk_mesh_write(all.mesh, argv[2], NULL, &error);
  if (code == PSK_OK)
    printf("%lld points on %s: %lld triangles, %s, volume %g, highest z %g\n", (long long)psk_cloud_size(all.cloud),
           psk_workspace_device_name(all.workspace), (long long)report.triangles,
           report.watertight ? "watertight" : "not watertight", report.volume, highest(all.mesh));
  else
    fprintf(stderr, "reconstruct: %s\n", error.message);
  free_all(&all);
  return code;
}
