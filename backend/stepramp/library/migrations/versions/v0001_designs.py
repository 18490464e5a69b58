"""Designs with their tags and revisions."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make the first tables."""
    op.create_table(
        "designs",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("name", sa.Text, nullable=False),
        sa.Column("notes", sa.Text, nullable=False),
        sa.Column("version", sa.Integer, nullable=False),
        sa.Column("saved_at", sa.String(32), nullable=False, index=True),
        sa.Column("searched", sa.Text, nullable=False),
    )
    op.create_table(
        "tags",
        sa.Column("design_id", sa.String(32), sa.ForeignKey("designs.id"), primary_key=True),
        sa.Column("place", sa.Integer, primary_key=True),
        sa.Column("tag", sa.Text, nullable=False, index=True),
    )
    op.create_table(
        "revisions",
        sa.Column("design_id", sa.String(32), sa.ForeignKey("designs.id"), primary_key=True),
        sa.Column("number", sa.Integer, primary_key=True),
        sa.Column("content", sa.Text, nullable=False),
        sa.Column("content_hash", sa.String(64), nullable=False, index=True),
        sa.Column("note", sa.Text, nullable=False),
        sa.Column("saved_at", sa.String(32), nullable=False),
    )
