#include <kerf/kerf.h>
#include <stdio.h>

int main(void) {
  const float vertices[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  kerf_mesh square = KERF_MESH_INIT;
  square.vertices = vertices;
  square.vertex_count = 4;
  square.triangles = triangles;
  square.triangle_count = 2;

  kerf_bvh* bvh;
  if (kerf_build(&square, 1, NULL, &bvh) != KERF_OK) {
    fprintf(stderr, "%s\n", kerf_last_error());
    return 1;
  }
  const kerf_ray down = {{0.75f, 0.25f, 2}, {0, 0, -1}, 0, 10};
  kerf_hit hit;
  if (kerf_intersect(bvh, &down, &hit)) printf("triangle %u at t = %g\n", hit.primitive, hit.t);
  kerf_bvh_release(bvh);
  return 0;
}
