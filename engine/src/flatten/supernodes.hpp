#pragma once

#include <cstdint>
#include <vector>

namespace partuv {

/// The pattern of a symmetric matrix below its diagonal, by row: row i has entries in the columns
/// before[start[i]] .. before[start[i + 1] - 1], ascending, all before i.
struct LowerPattern {
  std::vector<int32_t> start, before;
  std::vector<int32_t> parent;  ///< of each column in the elimination tree, -1 at a root

  int rows() const { return static_cast<int>(start.size()) - 1; }
};

/// The structure of a Cholesky factor: runs of columns (supernodes) that share their rows below,
/// as a tree in which children come before their parents. Each supernode is factored as a dense
/// front, its own columns first, then the rows below.
struct Supernodes {
  std::vector<int32_t> first;         ///< S + 1: first column of each
  std::vector<int32_t> parent;        ///< S: -1 at a root
  std::vector<int64_t> row_start;     ///< S + 1: its rows below are rows[row_start[s]] onwards
  std::vector<int32_t> rows;          ///< ascending
  std::vector<int32_t> place;         ///< like rows: where each lies in the parent's front
  std::vector<int32_t> column_start;  ///< columns + 1: the matrix's entries below the diagonal
  std::vector<int32_t> entry;         ///< by column: number of the entry
  std::vector<int32_t> entry_place;   ///< by column: where the entry lies in its front

  int count() const { return static_cast<int>(parent.size()); }
  int columns(int s) const { return first[s + 1] - first[s]; }
  int below(int s) const { return static_cast<int>(row_start[s + 1] - row_start[s]); }
};

/// The order of the matrix must be a postorder of its elimination tree. Supernodes that differ by
/// few entries are joined (Ashcraft, Grimes 1989): the fewer fronts are worth the zeros in them.
Supernodes find_supernodes(const LowerPattern& lower);

}  // namespace partuv
