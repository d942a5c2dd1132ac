! cellfan from Fortran: the structures and functions of include/cellfan.h that a simulation needs. Copy this file into your code.
module cellfan
  use, intrinsic :: iso_c_binding
  implicit none

  integer(c_int32_t), parameter :: cellfan_i32 = 5, cellfan_i64 = 7, cellfan_f32 = 9, cellfan_f64 = 10
  integer(c_int32_t), parameter :: cellfan_points = 0, cellfan_cells = 1
  integer(c_int32_t), parameter :: cellfan_tetrahedra = 10, cellfan_hexahedra = 12

  type, bind(c) :: cellfan_slice
    type(c_ptr) :: data = c_null_ptr
    integer(c_size_t) :: len = 0
    integer(c_int32_t) :: type = 0
  end type

  type, bind(c) :: cellfan_mesh
    type(cellfan_slice) :: positions, y, z, connectivity
    integer(c_int32_t) :: kind = 0
    type(cellfan_slice) :: types, offsets
    integer(c_size_t) :: dims(3) = 0
    type(cellfan_slice) :: scalars
    integer(c_int32_t) :: association = 0
  end type

  type, bind(c) :: cellfan_camera
    real(c_double) :: eye(3), target(3), up(3), fov_degrees, height_world
    integer(c_int32_t) :: width, height
    real(c_double) :: near = 0, far = 0
  end type

  type, bind(c) :: cellfan_control_point
    real(c_double) :: value, color(3), extinction
  end type

  type, bind(c) :: cellfan_stats
    integer(c_int64_t) :: drawn, culled_transparent, culled_outside, invalid, degenerate
    integer(c_int32_t) :: is_exact
    real(c_double) :: frame_ms
  end type

  interface
    integer(c_int32_t) function cellfan_session_new(mesh, threads, session) bind(c)
      import :: cellfan_mesh, c_size_t, c_ptr, c_int32_t
      type(cellfan_mesh), intent(in) :: mesh
      integer(c_size_t), value :: threads
      type(c_ptr), intent(out) :: session
    end function

    integer(c_int32_t) function cellfan_session_free(session) bind(c)
      import :: c_ptr, c_int32_t
      type(c_ptr), value :: session
    end function

    integer(c_int32_t) function cellfan_session_update_scalars(session, of, values) bind(c)
      import :: c_ptr, c_int32_t, cellfan_slice
      type(c_ptr), value :: session
      integer(c_int32_t), value :: of
      type(cellfan_slice), value :: values
    end function

    integer(c_int32_t) function cellfan_session_update_positions(session, x, y, z) bind(c)
      import :: c_ptr, c_int32_t, cellfan_slice
      type(c_ptr), value :: session
      type(cellfan_slice), value :: x, y, z
    end function

    integer(c_int32_t) function cellfan_session_value_range(session, range) bind(c)
      import :: c_ptr, c_int32_t, c_double
      type(c_ptr), value :: session
      real(c_double), intent(out) :: range(2)
    end function

    integer(c_int32_t) function cellfan_camera_framing(session, azimuth, elevation, width, height, camera) bind(c)
      import :: c_ptr, c_int32_t, c_double, cellfan_camera
      type(c_ptr), value :: session
      real(c_double), value :: azimuth, elevation
      integer(c_int32_t), value :: width, height
      type(cellfan_camera), intent(out) :: camera
    end function

    integer(c_int32_t) function cellfan_preset(session, name, points, capacity, points_len) bind(c)
      import :: c_ptr, c_int32_t, c_char, c_size_t, cellfan_control_point
      type(c_ptr), value :: session
      character(kind=c_char), intent(in) :: name(*)
      type(cellfan_control_point), intent(out) :: points(*)
      integer(c_size_t), value :: capacity
      integer(c_size_t), intent(out) :: points_len
    end function

    ! options: c_null_ptr for the default, or c_loc of a structure of your own.
    integer(c_int32_t) function cellfan_session_render(session, camera, points, points_len, options, rgba, rgba_len, stats) bind(c)
      import :: c_ptr, c_int32_t, c_size_t, c_float, cellfan_camera, cellfan_control_point, cellfan_stats
      type(c_ptr), value :: session
      type(cellfan_camera), intent(in) :: camera
      type(cellfan_control_point), intent(in) :: points(*)
      integer(c_size_t), value :: points_len
      type(c_ptr), value :: options
      real(c_float), intent(inout) :: rgba(*)
      integer(c_size_t), value :: rgba_len
      type(cellfan_stats), intent(out) :: stats
    end function

    integer(c_int32_t) function cellfan_save(path, width, height, rgba, rgba_len) bind(c)
      import :: c_int32_t, c_char, c_float, c_size_t
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int32_t), value :: width, height
      real(c_float), intent(in) :: rgba(*)
      integer(c_size_t), value :: rgba_len
    end function

    function cellfan_last_error_c() bind(c, name="cellfan_last_error") result(text)
      import :: c_ptr
      type(c_ptr) :: text
    end function
  end interface

contains

  ! What went wrong last.
  function cellfan_last_error() result(text)
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: characters(:)
    integer :: i
    call c_f_pointer(cellfan_last_error_c(), characters, [4096])
    text = ""
    do i = 1, 4096
      if (characters(i) == c_null_char) exit
      text = text // characters(i)
    end do
  end function
end module
