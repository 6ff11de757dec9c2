#include "exec/cpu_primitives.hpp"
#include "surface/pieces_impl.hpp"

namespace pointskin::surface {

template Surface keep_pieces(exec::Cpu&, Surface, const PieceOptions&, PieceCounts&);

}  // namespace pointskin::surface
