// What a module for an implementation of MPI offers, in C: it is loaded where a launcher of that implementation started the
// process. The modules are in mpi/.
#pragma once

extern "C" {

/// Every function but the last returns 0, or an error code of MPI.
struct PointskinMpi {
  int version;  ///< of this struct
  int (*start)(int* rank, int* size, int* rank_on_host);
  /// One message at a time: of `count` bytes from rank `root` to all others.
  int (*begin_broadcast)(void* data, int count, int root);
  int (*test)(int* is_done);
  int (*stop)(void);  ///< waits for all ranks
  const char* (*error_text)(int error);
  void (*end_all)(int exit_code);
};
}

#define POINTSKIN_MPI_VERSION 1
/// The name of the function of a module that returns its PointskinMpi.
#define POINTSKIN_MPI_SYMBOL "pointskin_mpi"
