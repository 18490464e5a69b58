"""Devices that were seen, what was pushed to them, and records of designs: traces, captures and stall maps."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Make them."""
    op.create_table(
        "devices",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("family", sa.Text, nullable=False),
        sa.Column("identity", sa.Text, nullable=False),
        sa.Column("name", sa.Text, nullable=False),
        sa.Column("port", sa.Text, nullable=False),
        sa.Column("first_seen_at", sa.String(32), nullable=False),
        sa.Column("last_seen_at", sa.String(32), nullable=False, index=True),
    )
    op.create_table(
        "pushes",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("device_id", sa.String(32), sa.ForeignKey("devices.id"), nullable=False, index=True),
        sa.Column("pushed_at", sa.String(32), nullable=False, index=True),
        sa.Column("client", sa.Text),
        sa.Column("mode", sa.Text, nullable=False),
        sa.Column("trouble", sa.Text),
        sa.Column("report", sa.Text),
        sa.Column("backup", sa.Text),
    )
    op.create_table(
        "pushed_axes",
        sa.Column("push_id", sa.String(32), sa.ForeignKey("pushes.id"), primary_key=True),
        sa.Column("axis", sa.Integer, primary_key=True),
        sa.Column("name", sa.Text, nullable=False),
        sa.Column("content", sa.Text, nullable=False),
        sa.Column("content_hash", sa.String(64), nullable=False, index=True),
    )
    op.create_table(
        "records",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("design_id", sa.String(32), sa.ForeignKey("designs.id"), nullable=False, index=True),
        sa.Column("revision", sa.Integer, nullable=False),
        sa.Column("kind", sa.Text, nullable=False),
        sa.Column("note", sa.Text, nullable=False),
        sa.Column("content", sa.Text, nullable=False),
        sa.Column("kept_at", sa.String(32), nullable=False),
    )
