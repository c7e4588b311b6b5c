// Counts the CPU time that each process spends in MPI's collective calls, mostly waiting for
// others, and prints it at the end. For `scripts/benchmarks/simulate real`.
//
//   mpicc -O2 -shared -fPIC -o mpi-waiting.so scripts/lib/mpi-waiting.c
//   scripts/benchmarks/simulate real FILE --launch "mpirun -x LD_PRELOAD=$PWD/mpi-waiting.so"
#include <mpi.h>
#include <stdio.h>
#include <time.h>

static double total;

static double cpu(void) {
  struct timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

#define RETURN_COUNTED(call)     \
  do {                           \
    const double before = cpu(); \
    const int error = call;      \
    total += cpu() - before;     \
    return error;                \
  } while (0)

int MPI_Init_thread(int* argc, char*** argv, int required, int* provided) {
  RETURN_COUNTED(PMPI_Init_thread(argc, argv, required, provided));
}

int MPI_Allreduce(const void* sent, void* received, int count, MPI_Datatype type, MPI_Op operation,
                  MPI_Comm all) {
  RETURN_COUNTED(PMPI_Allreduce(sent, received, count, type, operation, all));
}

int MPI_Exscan(const void* sent, void* received, int count, MPI_Datatype type, MPI_Op operation,
               MPI_Comm all) {
  RETURN_COUNTED(PMPI_Exscan(sent, received, count, type, operation, all));
}

int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm all) {
  RETURN_COUNTED(PMPI_Bcast(data, count, type, root, all));
}

int MPI_Barrier(MPI_Comm all) { RETURN_COUNTED(PMPI_Barrier(all)); }

int MPI_Recv(void* data, int count, MPI_Datatype type, int source, int tag, MPI_Comm all,
             MPI_Status* status) {
  RETURN_COUNTED(PMPI_Recv(data, count, type, source, tag, all, status));
}

int MPI_Alltoall(const void* sent, int sent_count, MPI_Datatype sent_type, void* received,
                 int received_count, MPI_Datatype received_type, MPI_Comm all) {
  RETURN_COUNTED(
      PMPI_Alltoall(sent, sent_count, sent_type, received, received_count, received_type, all));
}

int MPI_Alltoallv(const void* sent, const int* sent_counts, const int* sent_begins,
                  MPI_Datatype sent_type, void* received, const int* received_counts,
                  const int* received_begins, MPI_Datatype received_type, MPI_Comm all) {
  RETURN_COUNTED(PMPI_Alltoallv(sent, sent_counts, sent_begins, sent_type, received,
                                received_counts, received_begins, received_type, all));
}

int MPI_File_open(MPI_Comm all, const char* name, int mode, MPI_Info info, MPI_File* file) {
  RETURN_COUNTED(PMPI_File_open(all, name, mode, info, file));
}

int MPI_File_close(MPI_File* file) { RETURN_COUNTED(PMPI_File_close(file)); }

int MPI_Finalize(void) {
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  fprintf(stderr, "mpi-waiting %d %.6f\n", rank, total);
  return PMPI_Finalize();
}
