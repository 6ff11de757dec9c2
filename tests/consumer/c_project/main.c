/* A stranger's program in C: a cube of points becomes a watertight mesh. */
#include <pointskin/c.h>

#include <stdio.h>

enum { kSide = 20, kCount = 6 * kSide * kSide };

int main(void) {
  static float positions[kCount][3], normals[kCount][3];
  int n = 0;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j, ++n) {
        const int axis = face / 2, side = face % 2;
        positions[n][axis] = (float)side;
        positions[n][(axis + 1) % 3] = (i + 0.5F) / kSide;
        positions[n][(axis + 2) % 3] = (j + 0.5F) / kSide;
        normals[n][axis] = side ? 1 : -1;
      }

  psk_points points;
  psk_options options;
  psk_mesh_report report;
  psk_error error;
  PSK_INIT_AS(PSK_STRUCT_POINTS, points);
  PSK_INIT_AS(PSK_STRUCT_OPTIONS, options);
  PSK_INIT_AS(PSK_STRUCT_MESH_REPORT, report);
  points.positions.data = positions;
  points.positions.rows = kCount;
  points.positions.components = 3;
  points.positions.type = PSK_FLOAT32;
  points.normals = points.positions;
  points.normals.data = normals;
  options.depth = 6;

  psk_workspace* workspace = NULL;
  psk_reconstructor* reconstructor = NULL;
  psk_mesh* mesh = NULL;
  if (psk_workspace_create("cpu", 0, &workspace, &error) != PSK_OK ||
      psk_reconstructor_create(workspace, &reconstructor, &error) != PSK_OK ||
      psk_reconstruct_points(reconstructor, &points, &options, PSK_HOST, &mesh, &error) != PSK_OK ||
      psk_mesh_measure(mesh, 0, &report, &error) != PSK_OK) {
    fprintf(stderr, "%s\n", error.message);
    return 1;
  }
  printf("pointskin %s: %lld triangles, volume %g\n", psk_version(), (long long)report.triangles, report.volume);
  psk_mesh_free(mesh);
  psk_reconstructor_free(reconstructor);
  psk_workspace_free(workspace);
  return report.watertight && report.volume > 0.9 && report.volume < 1.1 ? 0 : 2;
}
