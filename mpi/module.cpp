// The module of one implementation of MPI; compiled once for each that is there.
#include <mpi.h>

#include "ranks/mpi_module.hpp"

namespace {

MPI_Request request = MPI_REQUEST_NULL;

int start(int* rank, int* size, int* rank_on_host) {
  int given = 0;
  if (const int error = MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given)) return error;
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  if (const int error = MPI_Comm_rank(MPI_COMM_WORLD, rank)) return error;
  if (const int error = MPI_Comm_size(MPI_COMM_WORLD, size)) return error;
  MPI_Comm host;
  if (const int error = MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, *rank, MPI_INFO_NULL, &host))
    return error;
  if (const int error = MPI_Comm_rank(host, rank_on_host)) return error;
  return MPI_Comm_free(&host);
}

int begin_broadcast(void* data, int count, int root) {
  return MPI_Ibcast(data, count, MPI_BYTE, root, MPI_COMM_WORLD, &request);
}

int test(int* is_done) { return MPI_Test(&request, is_done, MPI_STATUS_IGNORE); }

int stop() { return MPI_Finalize(); }

const char* error_text(int error) {
  static char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  if (MPI_Error_string(error, text, &length) != MPI_SUCCESS) text[0] = '\0';
  return text;
}

void end_all(int exit_code) { MPI_Abort(MPI_COMM_WORLD, exit_code); }

}  // namespace

extern "C" __attribute__((visibility("default"))) const PointskinMpi* pointskin_mpi() {
  static const PointskinMpi module = {POINTSKIN_MPI_VERSION, start, begin_broadcast, test, stop, error_text, end_all};
  return &module;
}
