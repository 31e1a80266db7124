// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "lines/feature_lines.hpp"
#include "remesh/dual.hpp"
#include "remesh/far_places.hpp"
#include "remesh/kept_triangles.hpp"
#include "remesh/site_editor.hpp"
#include "sample/solve_classes.hpp"

namespace dapple {

/// Spacings: the longest edge of faces that are smaller than the cells.
inline constexpr double kFinerEdge = 0.5;

/// What counts as a line of a surface, if it is remeshed.
[[nodiscard]] LineRules rules_of(const Surface& surface, std::size_t count,
                                 const RemeshOptions& options);

/// The spacing along lines where the density is 1. Where it varies, lines may lie where it is
/// largest; they get no more sites than all together.
[[nodiscard]] double line_spacing(const Surface& surface, const FeatureLines& lines,
                                  std::size_t count);

/// A mesh, and what its vertices were in the one before.
struct TracedMesh {
  RemeshResult mesh;
  std::vector<Origin> origins;  ///< per vertex
};

/// What a remesh begins with; nothing: a random start.
struct Beginning {
  Sites solution = {};     ///< sites of an earlier remesh, with or without those on lines
  RemeshSites given = {};  ///< all sites, with those on lines, which name_lines() finds
  KeptTriangles kept = {};
};

/// Name the lines that sites are on, of those that are to be on lines or that stay.
void name_lines(const Surface& surface, const FeatureLines& lines, RemeshSites& sites);

/// Finds the sites whose dual is the mesh.
class Remesher {
 public:
  /// The surface and the options must outlive it.
  Remesher(const Surface& surface, std::size_t count, const RemeshOptions& options,
           FeatureLines lines, Beginning beginning = {})
      : surface_(surface),
        count_(count),
        options_(options),
        lines_(std::move(lines)),
        given_(std::move(beginning.given)),
        kept_(std::move(beginning.kept)),
        solution_(std::move(beginning.solution)) {}

  /// Take cells by distances along the surface, whose faces are to be smaller than the cells.
  void follow_surface() { along_ = std::make_shared<const CellsAlong>(surface_); }

  void run(Context* context);

  /// Drop creases and marked edges where nothing else helps, after run() has left flaws.
  void give_up(Context* context);

  /// The best mesh, with its thin triangles made wider.
  [[nodiscard]] TracedMesh result(Context* context) const;
  [[nodiscard]] std::size_t flaws() const { return best_.violations.size(); }

  /// Per face the longest edge with which cells that are flawed have faces smaller than themselves.
  [[nodiscard]] std::vector<double> finer_edges() const;

  /// The sites of the last solution, before any were added for the topology.
  [[nodiscard]] const Sites& solution() const { return solution_; }
  /// Those that are on no line.
  [[nodiscard]] Sites free_sites() const { return without_first(solution_, solved_lines_); }

 private:
  /// Drop creases at which the topology cannot be reached, such as two that touch; then marked
  /// edges.
  bool drop_hopeless();
  void solve(Context* context);
  /// Space the given sites evenly from where they are.
  void solve_given(Context* context);
  [[nodiscard]] ClassMinimum solve_anew(const SampleClass& all, Context* context) const;
  /// So many sites of the earlier solution: those farthest from places on lines, which may be their
  /// own; none if there are too few, or not as many where there are no lines.
  [[nodiscard]] Sites solution_beside(const Sites& places, std::size_t count) const;
  /// Space free sites evenly among those on lines, from where they are.
  [[nodiscard]] ClassMinimum solve_from(const Sites& on_lines, const Sites& start,
                                        Context* context) const;
  /// Sites on the edges of thin walls belong to both sides, which are not taken apart then.
  [[nodiscard]] ClassProblem problem_of(const SampleClass& all) const;
  /// Space the free sites among the marked ones evenly again.
  void settle(const std::vector<bool>& moving, Context* context);
  void look(Context* context);
  /// Add sites until the dual has the topology of the surface, or adding more does not help.
  void mend_all(Context* context);
  void keep_best();
  void thin_all(Context* context);
  /// Take away as many sites as there are too many, where the topology does not need them.
  /// \param skipped sites that would be the first, but that did not help
  bool thin(Context* context, std::size_t skipped = 0);
  /// Where triangles face away from the surface, as across its folds, add sites, and take as many
  /// away elsewhere.
  void turn_all(Context* context);
  /// Whether no triangle of the best mesh faces away any more once thin ones are wider, which costs
  /// far less than more sites.
  [[nodiscard]] bool polish_turns_all(Context* context) const;
  [[nodiscard]] std::vector<Violation> away_from_surface(const Dual& dual,
                                                         const RemeshSites& sites) const;
  /// \return whether fewer triangles face away, with as many sites as asked for if there were
  /// before
  bool turn(const std::vector<Violation>& away, std::size_t tried, Context* context);
  /// Add sites where the mesh and the surface are farther apart than they may be.
  void approach(Context* context);
  /// Where the last mesh is too far from the surface; it is kept if it is the nearest so far.
  [[nodiscard]] FarPlaces far_places(const DistanceCheck& check, Context* context);
  /// Make thin triangles of a mesh wider, if it stays within the limit of the distance.
  /// \return the distance
  double polish_within_limit(RemeshSites& sites, Dual& dual, Context* context) const;
  /// Space those free sites evenly that were not added where they are needed.
  void settle_others(Context* context);

  const Surface& surface_;
  std::size_t count_;
  const RemeshOptions& options_;
  FeatureLines lines_;
  RemeshSites given_;  // none: sites are to be found
  KeptTriangles kept_;
  std::shared_ptr<const CellsAlong> along_;  // null: cells in space
  Sites solution_;                           // of the last solve(), those on lines first
  std::size_t solved_lines_ = 0;             // of them
  RemeshSites sites_, best_sites_;
  Dual dual_, best_;
  std::size_t dropped_lines_ = 0;
  bool gives_up_ = false;        // lines may be dropped
  double distance_ = 0.0;        // of the best mesh; 0: it was not looked at
  RemeshSites looked_at_sites_;  // by the last far_places()
  int evaluations_ = 0;
  bool converged_ = true;
};

}  // namespace dapple
