! A first picture from Fortran: a curvilinear grid in the solver's own arrays, an axis an array, drawn at every step.
! Build: see ../c/README.md. Run: first OUT.png. Checks what it draws; stops with 1 where something is wrong.
program first
  use cellfan
  implicit none
  integer, parameter :: ni = 24, nj = 12, nk = 10, width = 96, height = 72
  real(c_double), parameter :: pi = acos(-1.0_c_double)
  real(c_double), target :: x(ni, nj, nk), y(ni, nj, nk), z(ni, nj, nk)
  real(c_float), target :: temperature(ni, nj, nk), rgba(4, width, height)
  type(cellfan_mesh) :: mesh
  type(cellfan_camera) :: camera
  type(cellfan_control_point) :: colors(64)
  type(cellfan_stats) :: stats
  type(c_ptr) :: session
  integer(c_size_t) :: colors_len
  real(c_double) :: range(2), angle, radius
  character(len=1024) :: path
  integer :: i, j, k, step

  do k = 1, nk
    do j = 1, nj
      do i = 1, ni
        angle = 1.5_c_double * pi * (i - 1) / (ni - 1)
        radius = 1.0_c_double + 0.8_c_double * (j - 1) / (nj - 1)
        x(i, j, k) = radius * cos(angle)
        y(i, j, k) = radius * sin(angle)
        z(i, j, k) = 1.5_c_double * (k - 1) / (nk - 1)
      end do
    end do
  end do
  mesh%positions = cellfan_slice(c_loc(x), size(x, kind=c_size_t), cellfan_f64)
  mesh%y = cellfan_slice(c_loc(y), size(y, kind=c_size_t), cellfan_f64)
  mesh%z = cellfan_slice(c_loc(z), size(z, kind=c_size_t), cellfan_f64)
  mesh%dims = [ni, nj, nk]
  call check(cellfan_session_new(mesh, 2_c_size_t, session))
  call check(cellfan_camera_framing(session, 50.0_c_double, 40.0_c_double, width, height, camera))

  do step = 1, 3
    do k = 1, nk
      do j = 1, nj
        do i = 1, ni
          temperature(i, j, k) = real(sin(0.3 * i + step) * cos(0.4 * j) + 0.1 * k, c_float)
        end do
      end do
    end do
    call check(cellfan_session_update_scalars(session, cellfan_points, &
      cellfan_slice(c_loc(temperature), size(temperature, kind=c_size_t), cellfan_f32)))
    call check(cellfan_preset(session, "inferno" // c_null_char, colors, 64_c_size_t, colors_len))
    call check(cellfan_session_render(session, camera, colors, colors_len, c_null_ptr, rgba, &
      size(rgba, kind=c_size_t), stats))
  end do

  call check(cellfan_session_value_range(session, range))
  print "(a,i0,a,f8.3,a,f8.3,a,f8.3)", "cells ", stats%drawn, ", values ", range(1), " to ", range(2), &
    ", most opaque ", maxval(rgba(4, :, :))
  if (stats%drawn + stats%culled_transparent + stats%culled_outside /= (ni - 1) * (nj - 1) * (nk - 1)) stop 1
  if (abs(range(2) - maxval(temperature)) > 1e-6 .or. stats%is_exact /= 1) stop 1
  if (maxval(rgba(4, :, :)) < 0.1 .or. maxval(rgba(4, :, :)) > 1.0) stop 1
  ! A mesh that is none is told.
  mesh%dims = [ni, nj, nk + 1]
  block
    type(c_ptr) :: other
    if (cellfan_session_new(mesh, 1_c_size_t, other) == 0) stop 1
    if (index(cellfan_last_error(), "points") == 0) stop 1
  end block

  if (command_argument_count() > 0) then
    call get_command_argument(1, path)
    call check(cellfan_save(trim(path) // c_null_char, width, height, rgba, size(rgba, kind=c_size_t)))
  end if
  call check(cellfan_session_free(session))

contains

  subroutine check(status)
    integer(c_int32_t), intent(in) :: status
    if (status == 0) return
    print "(a)", cellfan_last_error()
    stop 1
  end subroutine
end program
