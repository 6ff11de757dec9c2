#include "exec/cuda_primitives.cuh"
#include "surface/pieces_impl.hpp"

namespace pointskin::surface {

template Surface keep_pieces(exec::Cuda&, Surface, const PieceOptions&, PieceCounts&);

}  // namespace pointskin::surface
