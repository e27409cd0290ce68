#include "step/contact_at_sites.hpp"

#include "functions/contact_sites.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// Sweeps over the sites. The impulses of the step before are a good beginning, so few do.
constexpr int k_sweeps = 2;

/// The passes, and what ranks share between them. A site is the work of the rank whose soil is nearest to it.
template <class Space, class T, int Dim>
struct SitesOfRanks {
  SitePasses<Space, T, Dim> passes;
  Decomposition<Space, T, Dim>* ranks;
  When when;

  PetscErrorCode share(SiteField field) const {
    PetscFunctionBeginUser;
    if (ranks)
      PetscCall(ranks->exchange_nodes(
          passes.s, passes.width(field), when,
          [&](const HaloLists<Space>& lists, T* out) { passes.pack(field, lists, out); },
          [&](const HaloLists<Space>& lists, const T* in) { passes.combine(field, lists, in); }));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Finds the sites, and begins their impulses.
  PetscErrorCode begin() const {
    PetscFunctionBeginUser;
    passes.find();
    PetscCall(share(SiteField::gaps));
    passes.couple();
    PetscCall(share(SiteField::counts));
    passes.begin();
    PetscCall(share(SiteField::momentum));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscErrorCode sweep(int times) const {
    PetscFunctionBeginUser;
    for (int n = 0; n < times; ++n) {
      passes.sweep();
      PetscCall(share(SiteField::momentum));
      passes.take();
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
};

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode contact_at_sites(State<Space, T, Dim>& s, double dt, Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  list_sites(s);
  const SitesOfRanks<Space, T, Dim> sites{{s, dt, s.control}, ranks, When::in_step};
  PetscCall(sites.begin());
  sites.passes.take();
  PetscCall(sites.sweep(k_sweeps));
  if (s.scheme.damping > 0) {
    sites.passes.brake();
    PetscCall(sites.sweep(1));
  }
  sites.passes.end();
  PetscCall(sites.share(SiteField::kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode sum_site_forces(State<Space, T, Dim>& s, double dt, Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  list_sites(s);
  const SitesOfRanks<Space, T, Dim> sites{{s, dt, s.never_paused}, ranks, When::between_steps};
  PetscCall(sites.begin());
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                    \
  template PetscErrorCode contact_at_sites(State<Space, T, Dim>&, double, Decomposition<Space, T, Dim>*); \
  template PetscErrorCode sum_site_forces(State<Space, T, Dim>&, double, Decomposition<Space, T, Dim>*);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
