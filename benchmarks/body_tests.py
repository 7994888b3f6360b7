"""Run the tests of implicit bodies and of metamorphosis, T1 to T37 of the method, and write docs/body_tests.md."""

from __future__ import annotations

from acceptance_page import ROOT, write_page

#: What is asked, and below it the tests of it.
ASKED = """
T1 volume and area of quadrics
    implicit/test_isosurface.py::test_volume_and_area_of_solids_by_mesh_and_by_field
    implicit/test_isosurface.py::test_extrapolated_and_curved_extents_of_smooth_bodies
T2 order of volume and area
    implicit/test_isosurface.py::test_order_of_volume_and_area_is_two_and_that_of_curved_triangles_four
T3 torus
    implicit/test_isosurface.py::test_volume_and_area_of_solids_by_mesh_and_by_field
T4 CSG
    implicit/test_shapes.py::test_lens_steinmetz_and_difference_have_their_volumes
    implicit/test_shapes.py::test_inside_and_outside_add_up_by_count_of_cells
T5 slope of a reinitialised union
    implicit/test_shapes.py::test_reinitialized_union_has_unit_slope_in_the_band_off_creases
T6 convolution of segments
    implicit/test_blobs.py::test_closed_integrals_are_those_of_quadrature
    implicit/test_blobs.py::test_a_segment_cut_in_two_is_the_whole
T7 joints of segments
    implicit/test_blobs.py::test_a_long_segment_has_its_radius_also_at_a_joint
    implicit/test_blobs.py::test_bulge_at_a_joint_is_smaller_than_that_of_a_distance_surface
T8 potentials
    implicit/test_blobs.py::test_integral_of_a_potential_is_that_of_the_table
    implicit/test_blobs.py::test_slopes_at_the_rim_and_where_pieces_meet
T9 roots of rays through balls
    implicit/test_blobs.py::test_bezier_ordinates_of_wyvill_along_a_ray_are_those_of_nishita
    implicit/test_blobs.py::test_rays_through_a_ball_lose_no_root
T10 sphere tracing
    implicit/test_trace.py::test_rays_meet_an_ellipsoid_where_the_quadratic_says
    implicit/test_trace.py::test_rays_meet_a_torus_where_the_quartic_says
    implicit/test_trace.py::test_a_planned_hole_enters_and_leaves_a_body_as_often_as_it_does
T11 closed and manifold meshes
    implicit/test_isosurface.py::test_noise_is_closed_and_manifold
    implicit/test_isosurface.py::test_nodes_that_are_exactly_zero_leave_no_slivers
    implicit/test_isosurface.py::test_blocks_equal_the_whole_vertex_for_vertex
    implicit/test_isosurface.py::test_a_body_that_leaves_its_box_is_capped_on_the_box_or_named_open
T12 vertices and normals
    implicit/test_isosurface.py::test_vertices_are_on_the_surface_and_normals_are_those_of_the_body
T13 contacts are met
    bodies/test_contacts.py::test_contacts_are_met_by_both_kernels
    bodies/test_contacts.py::test_contacts_and_normals_are_met_at_map_coordinates
    bodies/test_fit.py::test_thousands_of_contacts_are_met_and_every_sample_keeps_its_side
T14 drilled bodies
    bodies/test_fit.py::test_ten_layouts_of_holes
    bodies/test_contacts.py::test_inequalities_come_closer_than_all_samples_as_equalities
T15 two balls fuse
    implicit/test_blobs.py::test_two_balls_fuse_at_their_distance
T16 Muraki's fit finds planted balls
    implicit/test_muraki.py::test_planted_balls_are_found_again
    implicit/test_muraki.py::test_identical_halves_are_a_saddle_and_those_apart_are_not
T17 Muraki's fit of other shapes
    implicit/test_muraki.py::test_energy_falls_with_every_split
    implicit/test_muraki.py::test_sixty_four_balls_each_lower_the_energy
    implicit/test_muraki.py::test_the_few_balls_tried_are_about_as_good_as_all
T18 C2
    implicit/test_grid.py::test_value_gradient_and_hessian_do_not_jump_at_cell_faces_but_the_third_derivative_does
T19 curvature
    implicit/test_grid.py::test_curvature_of_sphere_and_torus_converges
T20 reinitialisation
    implicit/test_grid.py::test_reinitialised_field_is_the_distance_to_fourth_order
    implicit/test_grid.py::test_ten_reinitialisations_leave_the_surface_in_place
T21 concentric spheres
    morphing/test_levelset.py::test_concentric_spheres_approach_each_other_exponentially
    morphing/test_morph.py::test_arrival_is_linear_between_concentric_spheres
T22 the same with curvature
    morphing/test_levelset.py::test_curvature_holds_the_front_back
T23 collapse by curvature
    morphing/test_levelset.py::test_a_sphere_collapses_by_its_curvature
T24 unit speed
    morphing/test_levelset.py::test_unit_speed_expands_a_sphere_and_gives_its_volume_back
    morphing/test_levelset.py::test_a_block_grows_rounded_corners
T25 notched disc and sphere
    morphing/test_transport.py::test_a_notched_disc_keeps_its_area_over_one_turn
    morphing/test_transport.py::test_a_notched_sphere_keeps_its_volume_over_one_turn
T26 ball to ring: when the hole opens
    morphing/test_levelset.py::test_a_ball_becomes_a_ring_once_and_when_it_has_to
    morphing/test_levelset.py::test_the_hole_opens_within_a_percent_of_its_time
    morphing/test_morph.py::test_the_hole_opens_once_and_when_it_has_to
T27 ball to ring: its end
    morphing/test_levelset.py::test_the_end_is_the_ring
    morphing/test_levelset.py::test_energy_and_symmetric_difference_never_rise
T28 drift
    morphing/test_levelset.py::test_the_clamp_keeps_every_step_in_the_corridor
    morphing/test_morph.py::test_nothing_leaves_the_corridor
T29 ends and identity
    morphing/test_morph.py::test_the_ends_are_the_given_bodies
    morphing/test_morph.py::test_a_body_on_its_way_to_itself_does_not_move
T30 unreached parts
    morphing/test_morph.py::test_a_ball_that_is_not_touched_is_named_before_and_reached_from_a_seed
T31 alignment
    morphing/test_align.py::test_a_turned_scaled_and_shifted_copy_is_found
    morphing/test_align.py::test_a_mirror_image_is_never_made
T32 left-out sections
    bodies/test_outlines.py::test_a_left_out_section_of_an_ellipsoid
    bodies/test_outlines.py::test_a_left_out_section_of_bodies_that_bend_and_branch
T33 sigma of planted offsets
    bodies/test_contacts.py::test_planted_offsets_are_measured_with_their_sign
    bodies/test_step.py::test_distances_from_the_solid_are_those_of_opencascade
T34 volumes and chance
    bodies/test_spread.py::test_bodies_of_kinds_that_were_used_and_not_used_to_calibrate
    bodies/test_outlines.py::test_p10_to_p90_holds_the_volume_of_most_bodies_of_outlines
    bodies/test_outlines.py::test_the_band_between_sections_holds_the_true_surface_of_varied_bodies
T35 cut by horizons
    bodies/test_cut.py::test_pieces_are_closed_and_add_up
    bodies/test_cut.py::test_two_sides_share_their_cut_face
T36 files
    bodies/test_triangle_files.py::test_triangles_as_vtk_reads_them
    bodies/test_triangle_files.py::test_triangles_as_trimesh_reads_them
    bodies/test_block_files.py::test_vti_as_vtk_reads_it
    bodies/test_block_files.py::test_bodies_in_ifc
    bodies/test_step.py::test_nurbs_solid_of_a_ring
    bodies/test_step.py::test_triangles_keep_the_volume
T37 determinism
    bodies/test_fit.py::test_same_input_same_bytes
    bodies/test_fit.py::test_the_number_of_threads_changes_nothing
    project/test_bodies.py::test_the_same_provenance_makes_the_same_body
    morphing/test_morph.py::test_the_same_bodies_make_the_same_bytes
"""
#: Where a test asks for less than the method, and what was measured of the rest.
SHORT = {
    "T32": "the test asks less of the horn at 5 planes and of the fork: see [Planted bodies](bodies.md)",
}


def main() -> int:
    """Run every test once and write the page."""
    head = [
        "# Tests of bodies and metamorphosis",
        "",
        "Made by `python benchmarks/body_tests.py`: the tests T1 to T37 of the method, each as a test of the suite. "
        "Cases that passed of those that ran, and their time on one shared machine.",
    ]
    return int(write_page(ROOT / "docs" / "body_tests.md", head, ASKED, SHORT) > 0)


if __name__ == "__main__":
    raise SystemExit(main())
