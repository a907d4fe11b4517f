#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/formats/patches/patch_check.h"
#include "pipeline/hdf5/h5_store.h"
#include "pipeline/model/patch_set.h"

namespace patchlight {

/// The facets of a scene's clusters, in turn. In a file a cluster is one primitive, and its facets stand apart.
struct ClusterFacets {
  std::vector<std::int32_t> counts;   ///< [clusters] Numbers of facets.
  std::vector<Primitive> primitives;  ///< [facets] `back` is an index into this list.
  std::vector<Texcoords> texcoords;   ///< [facets], and so are the following; each empty as in PatchSet.
  std::vector<Texcoords> emission_texcoords;
  std::vector<Texcoords> metallic_roughness_texcoords;
  std::vector<Texcoords> normal_texcoords;
  std::vector<CornerColors> colors;
  std::vector<CornerNormals> normals;
};

/// Takes the facets out of a scene. Afterwards each cluster is one primitive without corners, of which its patch is.
ClusterFacets take_facets(PatchSet& scene);

/// Undoes take_facets().
void put_facets(ClusterFacets facets, PatchSet& scene);

void write_cluster_datasets(H5Writer& writer, const ClusterFacets& facets);

/// Reads the facets and puts them into the scene. `is_cluster` [primitives of the file]. Refuses what does not fit.
void read_cluster_datasets(const H5Reader& reader, const std::vector<bool>& is_cluster, PatchSet& scene);

/// Faults of clusters: what emits light or has a mask is none, and both sides of a facet are of clusters.
PatchFault cluster_fault(const PatchSet& scene);

}  // namespace patchlight
